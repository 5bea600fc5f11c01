"""Prestressed bar in one dimension, MUSL SGMP, fixed ends: plain, normalised, and forms with kappa in the strain."""
import numpy as np, sys, numba as nb
@nb.njit(cache=True)
def run(mode, s, jit, seed, end, N, v0, cfl, flip):
    np.random.seed(seed); P=2*N; x=np.empty(P); V=np.full(P,.5); m=np.full(P,.5); v=np.zeros(P); sg=np.full(P,s)
    for p in range(P): x[p]=(p+.5)*.5+jit*.5*(np.random.random()*2-1); v[p]=v0*np.sin(np.pi*x[p]/N)
    Nc=N+2; dt=cfl/(1+abs(v0)); n=int(end/dt); out=np.zeros((n//50+1,5)); booked=0.; work=0.
    pot=0.5*s*s*N; U=pot
    for k in range(n):
        M=np.zeros(Nc); Q=np.zeros(Nc); T=np.zeros(Nc); W=np.zeros(Nc)      # centre c: x=c-.5 ; ghosts 0 and N+1
        for p in range(P):
            u=x[p]+.5; i=int(np.floor(u)); r=u-i
            M[i] += (1 - r) * m[p]
            M[i + 1] += r * m[p]
            Q[i] += (1 - r) * m[p] * v[p]
            Q[i + 1] += r * m[p] * v[p]
            T[i] += (1 - r) * sg[p] * V[p]
            T[i + 1] += r * sg[p] * V[p]
            W[i] += (1 - r) * V[p]
            W[i + 1] += r * V[p]
        for A in (M,T,W): A[1]+=A[0]; A[N]+=A[N+1]
        Q[1]-=Q[0]; Q[N]-=Q[N+1]
        ka=np.ones(Nc)
        if mode>0:
            for c in range(1,N+1): ka[c]=1/W[c]
        ka[0]=ka[1]; ka[N+1]=ka[N]
        mi=np.zeros(N+1); vi=np.zeros(N+1); a=np.zeros(N+1)
        for i in range(1,N):
            mi[i]=.5*(M[i]+M[i+1]); a[i]=(-T[i]*ka[i]+T[i+1]*ka[i+1])/mi[i]; vi[i]=.5*(Q[i]+Q[i+1])/mi[i]
        d=dt*(.5 if k==0 else 1.); vk=vi+a*d
        ac=np.zeros(Nc); vc=np.zeros(Nc)
        for c in range(1,N+1): ac[c]=.5*(a[c-1]+a[c]); vc[c]=.5*(vk[c-1]+vk[c])
        ac[0]=-ac[1]; ac[N+1]=-ac[N]; vc[0]=-vc[1]; vc[N+1]=-vc[N]
        Q[:]=0; xo=x.copy()
        for p in range(P):
            u=xo[p]+.5; i=int(np.floor(u)); r=u-i
            v[p]=v[p]+d*((1-r)*ac[i]+r*ac[i+1]); x[p]=xo[p]+dt*((1-r)*vc[i]+r*vc[i+1])
            Q[i]+=(1-r)*m[p]*v[p]; Q[i+1]+=r*m[p]*v[p]
        Q[1]-=Q[0]; Q[N]-=Q[N+1]
        for i in range(1,N): vi[i]=.5*(Q[i]+Q[i+1])/mi[i]
        L=np.zeros(Nc)
        for c in range(1,N+1): L[c]=vi[c]-vi[c-1]; booked+=dt*(ka[c]-1)*T[c]*L[c]
        Ls=L.copy(); Lv=L.copy()
        if mode==2: Ls=L*ka; Lv=Ls
        if mode==3: Lv=L*ka                           # volume by kappa, stress by the plain strain
        if mode==4: Ls=L*ka                           # stress by kappa, volume plain
        # volume relaxes to the room: only the part kappa-1 of the volume, per crossing time
        if mode==5:
            for c in range(1,N+1): Lv[c]=L[c]+abs(L[c])*(ka[c]-1)
        for A in (Ls,Lv): A[0]=A[1]; A[N+1]=A[N]
        for p in range(P):
            u=xo[p]+.5; i=int(np.floor(u)); r=u-i
            e=((1-r)*Ls[i]+r*Ls[i+1])*dt; g=((1-r)*Lv[i]+r*Lv[i+1])*dt; old=sg[p]; Vo=V[p]
            sg[p]+=e; V[p]*=(1+g); U+=.5*(old+sg[p])*e*.5*(Vo+V[p])
        if k%50==0:
            K=0.
            for p in range(P): K+=.5*m[p]*v[p]**2
            out[k//50]=np.array([dt*(k+1),K/pot,U/pot,np.mean(sg),booked/pot])
    return out[:(n-1)//50+1]
names=['plain','normalised','kappa in strain and volume','kappa in volume','kappa in strain','volume relaxes']
for s,j in((.1,1e-3),(.1,.1),(.01,.1),(-.1,.1),(-.1,1e-3)):
    for mode in range(5):
        o=run(mode,s,j,3,3000.,40,0.,.4,1.); at=lambda t,c:np.interp(t,o[:,0],o[:,c])
        print(
            's %5.2f jitter %.0e %-27s K/U0 at t=10 %.1e, 500 %.1e, 3000 %.1e, max %.1e; mean stress %.4f'
            % (s, j, names[mode], at(10, 1), at(500, 1), o[-1, 1], o[:, 1].max(), o[-1, 3]),
            flush=True,
        )
print('wave: v0 = 0.05 sin, s = 0.05, jitter 0.1: total energy (K+U), with booked')
for mode in range(5):
    o=run(mode,.05,.1,3,2000.,40,.05,.4,1.); E=o[:,1]+o[:,2]
    print(
        '%-27s drift of K+U at 80, 500, 2000: %.2e %.2e %.2e; with booked term: %.2e %.2e %.2e; K kept (max last '
        '200 over max first 200) %.3f'
        % (
            names[mode], *[np.interp(t, o[:, 0], E) / E[0] - 1 for t in (80, 500, 2000)],
            *[np.interp(t, o[:, 0], E + o[:, 4]) / E[0] - 1 for t in (80, 500, 2000)],
            o[-500:-1, 1].max() / o[:100, 1].max(),
        ),
        flush=True,
    )
