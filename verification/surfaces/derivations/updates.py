"""METHOD.md section 6 with pairs: identities of USF, USL, MUSL (linear elastic, constant V, uniform dt), random
particles in the plane; USAVG's halves."""
import numpy as np; from ops import *
rng=np.random.default_rng(0); n=400; lam,mu=1.2,.7
def tensor(S,Gx,Gy,v): a,b=v; return np.stack([Gx@a,Gy@b,Gy@a+Gx@b])
def stress(e): t=lam*(e[0]+e[1]); return np.stack([t+2*mu*e[0],t+2*mu*e[1],mu*e[2]])
dot=lambda a,b:a[0]*b[0]+a[1]*b[1]+a[2]*b[2]
for meth in('sgmp','sgmp+edge'):
    X = rng.uniform(0, 6, (n, 2))
    V = rng.uniform(0.5, 1.5, n) * 0.09
    m = V.copy()
    g = Grid(X)
    S, Gx, Gy = operators(meth, X, V, g)
    M = S.T @ m
    ok = M > 1e-9
    iM = np.where(ok, 1 / np.where(ok, M, 1), 0)
    dt=.3; v=rng.normal(size=(2,n)); sg=rng.normal(size=(3,n)); K=lambda v:.5*(m*(v**2).sum(0)).sum()
    comp = lambda s: (
        0.5
        * (
            V
            * dot(
                s,
                np.stack(
                    [
                        (s[0] * (lam + 2 * mu) - lam * s[1]) / ((lam + 2 * mu) ** 2 - lam**2),
                        (s[1] * (lam + 2 * mu) - lam * s[0]) / ((lam + 2 * mu) ** 2 - lam**2), s[2] / mu,
                    ]
                ),
            )
        ).sum()
    )
    F = lambda s: -np.stack([Gx.T @ (V * s[0]) + Gy.T @ (V * s[2]), Gy.T @ (V * s[1]) + Gx.T @ (V * s[2])])
    pr = lambda v: np.stack([iM * (S.T @ (m * c)) for c in v])
    ga = lambda a: np.stack([S @ c for c in a])
    D = lambda e: (V * dot(e, stress(e))).sum()
    E0 = K(v) + comp(sg)
    ma = lambda a: (m * (a**2).sum(0)).sum()
    MA = lambda a: (M * (a**2).sum(0)).sum()
    T=lambda u:tensor(S,Gx,Gy,u)
    e = dt * T(pr(v))
    s = sg + stress(e)
    a = F(s) * iM
    v1 = v + dt * ga(a)
    print(meth, 'USF  %.1e' % abs(K(v1) + comp(s) - E0 - (0.5 * dt**2 * ma(ga(a)) - 0.5 * D(e))), end=' ')
    a = F(sg) * iM
    v1 = v + dt * ga(a)
    e = dt * T(pr(v) + dt * a)
    s = sg + stress(e)
    print('USL %.1e' % abs(K(v1) + comp(s) - E0 - (-(dt**2) * MA(a) + 0.5 * dt**2 * ma(ga(a)) + 0.5 * D(e))), end=' ')
    e=dt*T(pr(v1)); s=sg+stress(e); print('MUSL %.1e'%abs(K(v1)+comp(s)-E0-(-.5*dt**2*ma(ga(a))+.5*D(e))),end=' ')
    e1=.5*dt*T(pr(v)); s1=sg+stress(e1); a=F(s1)*iM; v1=v+dt*ga(a); e2=.5*dt*T(pr(v1)); s2=s1+stress(e2)
    print(
        'USAVG (half before, half after, one set of k) %.1e'
        % abs(K(v1) + comp(s2) - E0 - (-0.5 * D(e1) + 0.5 * D(e2) + 0 * dt)),
        'relative to E0 %.2g' % E0,
    )
