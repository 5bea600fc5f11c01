"""Axisymmetric pairs: identity with the hoop term and flux test on an oblique (conical) free surface, away from the
axis and at it. h = 1, nodes r >= 0."""
import numpy as np
rng=np.random.default_rng(2); n=16; C=1/12
def W(X):
    # centre index 0: r=-.5 ghost; z index shifted
    u=X+np.array([.5,3.5]); i=np.floor(u).astype(int); return i,u-i
rc=np.arange(n)-.5
def scat(X,q):
    i,r=W(X); o=np.zeros((n,n)+q.shape[1:])
    for a in(0,1):
        for b in(0,1):
            w = (r[:, 0] if a else 1 - r[:, 0]) * (r[:, 1] if b else 1 - r[:, 1])
            np.add.at(o, (i[:, 0] + a, i[:, 1] + b), w.reshape((-1,) + (1,) * (q.ndim - 1)) * q)
    return o
def gath(X,A):
    i,r=W(X); o=0
    for a in(0,1):
        for b in(0,1):
            w = (r[:, 0] if a else 1 - r[:, 0]) * (r[:, 1] if b else 1 - r[:, 1])
            o = o + w.reshape((-1,) + (1,) * (A.ndim - 2)) * A[i[:, 0] + a, i[:, 1] + b]
    return o
def pr(X,V):
    i,r=W(X); mx,my=np.zeros((n,n)),np.zeros((n,n))
    for b in(0,1): np.add.at(mx,(i[:,0],i[:,1]+b),V*(r[:,1] if b else 1-r[:,1])*r[:,0]*(1-r[:,0]))
    for a in(0,1): np.add.at(my,(i[:,0]+a,i[:,1]),V*(r[:,0] if a else 1-r[:,0])*r[:,1]*(1-r[:,1]))
    return mx,my
def div(a,b): return np.where(b>1e-13,a/np.where(b>1e-13,b,1),0)
# centre c has nodes c-1, c (r = c-1 .. c); arrays of nodes v[i,j], i = radius
def D(v,k):
    o=np.zeros_like(v); a,b,c,d=v[:-1,:-1],v[1:,:-1],v[:-1,1:],v[1:,1:]
    o[1:,:-1]={'r':.5*(b+d-a-c),'z':.5*(c+d-a-b),'h':d-b-c+a,'m':.25*(a+b+c+d)}[k]; return o
def L(v,X,V,pair,hoop):
    """(rr, zz, theta, rz+zr) at particles; v[...,0]=v_r"""
    Vc=scat(X,V); mx,my=pr(X,V); Vc[1]+=Vc[0]; Vc[0]=0; my[1]+=my[0]; my[0]=0; mw=mx[0].copy(); mx[0]=0
    kx, ky = np.zeros((n, n)), np.zeros((n, n))
    kx[:-1] = 0.5 * div(mx[:-1], Vc[:-1] + Vc[1:])
    ky[:, :-1] = 0.5 * div(my[:, :-1], Vc[:, :-1] + Vc[:, 1:])
    kw = 0.5 * div(mw, Vc[1])
    Lr,Lz,H,m=D(v,'r'),D(v,'z'),D(v,'h'),D(v,'m'); dr0,dz0=Lr.copy(),Lz.copy()
    if pair:
        t=ky[:,:-1,None]*(H[:,:-1]-H[:,1:]); Lr[:,:-1]+=t; Lr[:,1:]+=t
        t=kx[:-1,:,None]*(H[:-1]-H[1:]); Lz[:-1]+=t; Lz[1:]+=t
        Lz[1,:,1]-=2*kw*H[1,:,1]                                   # axis: pair of a centre and its mirror, v_z only
    th=np.zeros((n,n)); th[1:]=m[1:,:,0]/rc[1:,None]
    vr = np.zeros_like(v[:, :, 0])
    vr[1:] = v[1:, :, 0] / np.arange(1, n)[:, None]
    zm = np.zeros((n, n))
    zm[:, :-1] = 0.5 * (vr[:, 1:] + vr[:, :-1])
    th[2:]+=C/rc[2:,None]*(zm[2:]-zm[1:-1])
    # mean value by B(z) [and B(r)] where it was S: pairs of d_z v_r, d_r v_r, over r
    if hoop:
        q=ky[:,:-1]*(dz0[:,:-1,0]-dz0[:,1:,0]); t=np.zeros((n,n)); t[:,:-1]+=q; t[:,1:]+=q; th[1:]+=t[1:]/rc[1:,None]
        if hoop==2:
            q = kx[1:-1] * (dr0[1:-1, :, 0] - dr0[2:, :, 0])
            t = np.zeros((n, n))
            t[1:-1] += q
            t[2:] += q
            t[1] = 0
            th[2:] += t[2:] / rc[2:, None]
    A=np.stack([Lr[:,:,0],Lz[:,:,1],th,Lz[:,:,0]+Lr[:,:,1]],-1); A[0]=A[1]*[1,1,1,-1]
    return gath(X,A)
def force(X,V,s,pair,hoop):
    f=np.zeros((n,n,2))
    for i in range(0,13):
        for j in range(1,13):
            for k in(0,1):
                if i==0 and k==0: continue
                e=np.zeros((n,n,2)); e[i,j,k]=1; f[i,j,k]=-(V[:,None]*s*L(e,X,V,pair,hoop)).sum()
    return f
def hand(X,V,s,pair,hoop):
    """Transpose written out, as for the program."""
    T = scat(X, s * V[:, None])
    T[1] += T[0] * [1, 1, 1, -1]
    T[0] = 0
    Vc = scat(X, V)
    mx, my = pr(X, V)
    Vc[1] += Vc[0]
    Vc[0] = 0
    my[1] += my[0]
    my[0] = 0
    mw = mx[0].copy()
    mx[0] = 0
    kx, ky = np.zeros((n, n)), np.zeros((n, n))
    kx[:-1] = 0.5 * div(mx[:-1], Vc[:-1] + Vc[1:])
    ky[:, :-1] = 0.5 * div(my[:, :-1], Vc[:, :-1] + Vc[:, 1:])
    kw = 0.5 * div(mw, Vc[1])
    ar = np.stack([T[:, :, 0], T[:, :, 3]], -1)
    az = np.stack([T[:, :, 3], T[:, :, 1]], -1)
    th = np.zeros((n, n))
    th[1:] = T[1:, :, 2] / rc[1:, None]
    Hf = np.zeros((n, n, 2))
    dz = az.copy()
    dr = ar.copy()
    if pair:
        t=ky[:,:-1,None]*(ar[:,:-1]+ar[:,1:]); Hf[:,:-1]+=t; Hf[:,1:]-=t
        t=kx[:-1,:,None]*(az[:-1]+az[1:]); Hf[:-1]+=t; Hf[1:]-=t; Hf[1,:,1]-=2*kw*az[1,:,1]
    if hoop:
        q=ky[:,:-1]*(th[:,:-1]+th[:,1:]); dz[:,:-1,0]+=q; dz[:,1:,0]-=q
        if hoop==2:
            w=th.copy(); w[1]=0; q=kx[1:-1]*(w[1:-1]+w[2:]); dr[1:-1,:,0]+=q; dr[2:,:,0]-=q
    f=np.zeros((n,n,2))
    for a in(0,1):
        for b in(0,1):
            f[a:n-1+a,b:n-1+b]-=dr[1:,:-1]*(a-.5)+dz[1:,:-1]*(b-.5)+Hf[1:,:-1]*((2*a-1)*(2*b-1))
            # centre c>=2: nodes c-1, c
            q=.25*th[1:,:-1].copy(); q[1:]+=C*(a*2-1)*.5*th[2:,:-1]/np.maximum(np.arange(1,n-1)[:,None]+a,1)
            f[a:n-1+a,b:n-1+b,0]-=q
    f[0,:,0]=0; return f
X = np.column_stack([rng.uniform(0, 5, 300), rng.uniform(-2, 5, 300)])
V = rng.uniform(0.5, 1.5, 300) * X[:, 0] * 0.1
s = rng.normal(size=(300, 4))
v = rng.normal(size=(n, n, 2))
v[0, :, 0] = 0
for pair,hoop in((0,0),(1,0),(1,1),(1,2)):
    P=(V[:,None]*s*L(v,X,V,pair,hoop)).sum()
    fh=hand(X,V,s,pair,hoop); print('pair',pair,'hoop',hoop,'identity relative %.1e'%(abs(P+(fh*v).sum())/abs(P)))
# flux: hydrostatic stress -1 in a body with conical faces; exact nodal force = closed integral of r n Phi ds with Phi =
# B B (mirrored at the axis) = sum A (d_r(r Phi), r d_z Phi) on fine points
def B(x):
    a=np.abs(x); return np.where(a<.5,.75-a*a,np.where(a<1.5,.5*(1.5-a)**2,0))
def dB(x):
    a=np.abs(x); return np.where(a<.5,-2*x,np.where(a<1.5,-(1.5-a)*np.sign(x),0))
for lo,name in((4.,'away from the axis'),(0.,'at the axis')):
    for th in (15, 30):
        N = 24
        a = np.arange(0, 13, 1 / N) + 0.5 / N
        b = np.arange(-3, 10, 1 / N) + 0.5 / N
        rr, zz = np.meshgrid(a, b, indexing='ij')
        X = np.column_stack([rr.ravel(), zz.ravel()])
        t = np.radians(th)
        q = (X[:, 1] - 3.0) * np.cos(t) - (X[:, 0] - lo - 2) * np.sin(t)
        ok = (np.abs(q) < 1.37) & (X[:, 0] > lo) & (X[:, 0] < lo + 5)
        X = X[ok]
        V = X[:, 0] / N**2
        s = np.tile([-1.0, -1, -1, 0], (len(X), 1))
        out = []
        ex = np.zeros((n, n, 2))
        for i in range(0, 13):
            for j in range(1, 13):
                r0, z0 = i, j - 4.0
                br, dr = B(X[:, 0] - r0), dB(X[:, 0] - r0)
                sg = [br, dr]
                if i:
                    brm, drm = B(X[:, 0] + r0), dB(X[:, 0] + r0)
                else:
                    brm, drm = 0, 0
                bz, dz = B(X[:, 1] - z0), dB(X[:, 1] - z0)
                ex[i, j, 0] = ((V * (dr - drm) + V / X[:, 0] * (br - brm)) * bz).sum() if i else 0
                ex[i, j, 1] = (V * (br + brm) * dz).sum()
        for pair, hoop in ((0, 0), (1, 0), (1, 1), (1, 2)):
            d = (hand(X, V, s, pair, hoop) - ex)[:13, 1:13]
            out.append('%d%d: f_r %.4f f_z %.4f' % (pair, hoop, np.abs(d[:, :, 0]).max(), np.abs(d[:, :, 1]).max()))
        print(name, th, 'error of nodal force over p h (per radian, r about %g)' % (lo + 2), ' | '.join(out))
