"""Walls: pairs by folded sums against a scene with mirror images; identity and patch test. h = 1, wall at x = 0, body
at x > 0."""
import numpy as np
rng=np.random.default_rng(1)
n=14; off=4                      # nodes -4..9 along x ; centres -4+.5...; wall node index 4 = x 0 ; y nodes -4..
def W(X):
    u=X-0.5+off; i=np.floor(u).astype(int); return i,u-i
def scat(X,q):                   # sum N q -> centres
    i,r=W(X); o=np.zeros((n,n)+q.shape[1:])
    for a in(0,1):
        for b in(0,1):
            w=(r[:,0] if a else 1-r[:,0])*(r[:,1] if b else 1-r[:,1])
            np.add.at(o,(i[:,0]+a,i[:,1]+b),w.reshape((-1,)+(1,)*(q.ndim-1))*q)
    return o
def gath(X,C):
    i,r=W(X); o=0
    for a in(0,1):
        for b in(0,1):
            w = (r[:, 0] if a else 1 - r[:, 0]) * (r[:, 1] if b else 1 - r[:, 1])
            o = o + w.reshape((-1,) + (1,) * (C.ndim - 2)) * C[i[:, 0] + a, i[:, 1] + b]
    return o
def pairs(X,V):                  # mx[c]: pair (c, c+x), hat along y; my
    i,r=W(X); mx,my=np.zeros((n,n)),np.zeros((n,n))
    for b in(0,1): np.add.at(mx,(i[:,0],i[:,1]+b),V*(r[:,1] if b else 1-r[:,1])*r[:,0]*(1-r[:,0]))
    for a in(0,1): np.add.at(my,(i[:,0]+a,i[:,1]),V*(r[:,0] if a else 1-r[:,0])*r[:,1]*(1-r[:,1]))
    return mx,my
def D(v,k):                      # nodes -> centres. centre c between nodes c, c+1
    o=np.zeros_like(v); a,b,c,d=v[:-1,:-1],v[1:,:-1],v[:-1,1:],v[1:,1:]
    o[:-1,:-1]={'x':.5*(b+d-a-c),'y':.5*(c+d-a-b),'h':d-b-c+a}[k]; return o
def div(a,b): return np.where(b>1e-13,a/np.where(b>1e-13,b,1),0)
g,c0=off-1,off                   # ghost centre x=-.5, first inner x=+.5 
def even(A):
    A=A.copy(); A[c0]+=A[g]; A[g]=0; return A
def grad(v,X,V,wall,cross=0):
    """L[...,i,a] at centres (inner), then ghosts filled; wall: 'slip','fixed' or None (free space)."""
    Vc=scat(X,V); Vg=Vc[g].copy(); mx,my=pairs(X,V)
    if wall:
        Vc=even(Vc); my=even(my)           # pairs along the wall: add the ghost's
        # pair across the wall: (g,c0); pairs (g-1,g) are empty: no particle lies there
        mw=mx[g].copy(); mx[g]=0
    kx, ky = np.zeros((n, n)), np.zeros((n, n))
    kx[:-1] = 0.5 * div(mx[:-1], Vc[:-1] + Vc[1:])
    ky[:, :-1] = 0.5 * div(my[:, :-1], Vc[:, :-1] + Vc[:, 1:])
    Lx,Ly,H=D(v,'x'),D(v,'y'),D(v,'h')
    inc=ky[:,:-1,None]*(H[:,:-1]-H[:,1:]); Lx[:,:-1]+=inc; Lx[:,1:]+=inc
    if wall: ok=np.arange(n-1)>=c0
    else: ok=np.ones(n-1,bool)
    inc=kx[:-1,:,None]*(H[:-1]-H[1:])*ok[:,None,None]; Ly[:-1]+=inc; Ly[1:]+=inc
    # mirrored H: component i along the wall is odd, normal even -> pair across: -2 k H, 0
    if wall=='slip':
        k=.5*div(mw,Vc[c0]);                 # 2 mw/(2 Vc) * 1/2
        Ly[c0,:,1]+=-2*k*H[c0,:,1]
    if wall=='fixed' and cross==1:
        Ly[c0]+=-div(Vg,Vc[c0])[:,None]*H[c0]   # exact weight of d_t v: 2d/h instead of 1
    L=np.stack([Lx,Ly],-1)                 # [...,i,a]
    if wall:
        s=np.ones((2,2))
        if wall=='slip': s=np.array([[1,-1],[-1,1]])
        L[g]=s*L[c0]
    return L
def constrain(v,wall):
    v=v.copy(); v[:off]=0
    if wall=='slip': v[off,:,0]=0
    else: v[off]=0
    return v
def mirror_v(v):
    w=v.copy()
    for k in range(1,off+1): w[off-k]=v[off+k]*[-1,1]
    w[off,:,0]=0; return w
# 1 slip = mirrored space
X=np.column_stack([rng.uniform(0,3,300),rng.uniform(-2,3,300)]); V=rng.uniform(.5,1.5,300)*.05
v=constrain(rng.normal(size=(n,n,2)),'slip'); L1=grad(v,X,V,'slip')
X2=np.concatenate([X,X*[-1,1]]); V2=np.concatenate([V,V]); L2=grad(mirror_v(v),X2,V2,None)
print('slip: folded against mirrored bodies, L at particles: %.1e'%np.abs(gath(X,L1)-gath(X,L2)).max())
# forces = exact transpose (by linearity): column by column
def forces(X,V,sig,wall,cross=0):
    f=np.zeros((n,n,2)); sV=sig*V[:,None,None]
    for i in range(off-1,n-3):
        for j in range(1,n-2):
            for k in(0,1):
                e=np.zeros((n,n,2)); e[i,j,k]=1
                if wall:
                    if np.abs(constrain(e,wall)).max()==0: continue
                f[i,j,k]=-(sV*gath(X,grad(e,X,V,wall,cross))).sum()
    return f
def centre_force(X,V,sig,wall):
    """Hand-written transpose of the folded form: what the program does."""
    T=scat(X,sig*V[:,None,None]); Vc=scat(X,V); mx,my=pairs(X,V)
    s=np.array([[1,-1],[-1,1]]) if wall=='slip' else np.ones((2,2))
    T[c0]+=s*T[g]; T[g]=0; Vc,my=even(Vc),even(my); mw=mx[g].copy(); mx[g]=0
    kx, ky = np.zeros((n, n)), np.zeros((n, n))
    kx[:-1] = 0.5 * div(mx[:-1], Vc[:-1] + Vc[1:])
    ky[:, :-1] = 0.5 * div(my[:, :-1], Vc[:, :-1] + Vc[:, 1:])
    Hf=np.zeros((n,n,2)); t=ky[:,:-1,None]*(T[:,:-1,:,0]+T[:,1:,:,0]); Hf[:,:-1]+=t; Hf[:,1:]-=t
    t=kx[:-1,:,None]*(T[:-1,:,:,1]+T[1:,:,:,1]); Hf[:-1]+=t; Hf[1:]-=t
    if wall=='slip': Hf[c0,:,1]+=-div(mw,Vc[c0])*T[c0,:,1,1]
    f=np.zeros((n,n,2))
    for a in(0,1):
        for b in(0,1):
            q=T[:-1,:-1,:,0]*(a-.5)+T[:-1,:-1,:,1]*(b-.5)+Hf[:-1,:-1]*((2*a-1)*(2*b-1)); f[a:n-1+a,b:n-1+b]-=q
    return constrain(f,wall)
sig=rng.normal(size=(300,2,2)); sig=sig+sig.transpose(0,2,1)
for w in('slip','fixed'):
    v = constrain(rng.normal(size=(n, n, 2)), w)
    p = (sig * V[:, None, None] * gath(X, grad(v, X, V, w))).sum()
    q = (centre_force(X, V, sig, w) * v).sum()
    print(w,'identity f.v + sum V sigma:L relative %.1e'%(abs(p+q)/abs(p)))
# patch: half plane strip oblique, meets the wall; uniform tension along e; free strip ends beyond view
def strip(theta,N):
    # cell-aligned fine points, cut by the strip
    a=np.arange(-4,9,1/N)+.5/N; xx,yy=np.meshgrid(a,a,indexing='ij'); X=np.column_stack([xx.ravel(),yy.ravel()])
    e=np.array([np.cos(theta),np.sin(theta)]); t=-X[:,0]*e[1]+(X[:,1]-1.0)*e[0]
    ok=(np.abs(t)<1.13)&(X[:,0]>0)&(X[:,0]<6); return X[ok],np.full(ok.sum(),1/N**2),e
for th in(8,15,30):
    X,V,e=strip(np.radians(th),48); S=np.tile(np.outer(e,e),(len(X),1,1)); out=[]
    for w,cr in(('slip',0),('fixed',0),('fixed',1)):
        f=forces(X,V,S,w,cr)
        if w=='slip': f[off]*=0 if False else 1
        out.append(
            '%s%s: first row of nodes %.4f second %.4f third %.4f'
            % (w, ' with cross' if cr else '', *[np.abs(f[off + k, 2:-4]).max() for k in (1, 2, 3)])
        )
    # plain for comparison: pair moments off
    P=pairs; globals()['pairs']=lambda X,V:(np.zeros((n,n)),np.zeros((n,n)))
    f=forces(X,V,S,'fixed'); globals()['pairs']=P
    out.append('plain fixed %.4f %.4f %.4f' % tuple(np.abs(f[off + k, 2:-4]).max() for k in (1, 2, 3)))
    print(th, ' | '.join(out))
    # slip wall: traction of the wall on tangential: expected flux for node row 0..1: mirrored stress state is not
    # uniform (shear odd), so the wall reaction is f = T e (e.n) * length on B
