fn set_c(p:&mut ContactParameters, q:&ContactParameters, hc:&[[f64;2]]) {
    for i in 0..KNOTS { let x=q.log_first+q.log_step*i as f64; 
        let c = if x<=hc[0][0] {hc[0][1]} else if x>=hc[hc.len()-1][0] {hc[hc.len()-1][1]} else { let j=hc.iter().position(|a|a[0]>x).unwrap(); let u=(x-hc[j-1][0])/(hc[j][0]-hc[j-1][0]); hc[j-1][1]+u*(hc[j][1]-hc[j-1][1]) };
        p.table[i][4]=c; } }
fn prepare(p:&mut ContactParameters, file:Option<&str>) { if std::env::var("P4").is_ok() {return;}
    let q=*p; let mut cs=[0.0;KNOTS];
    for i in 0..KNOTS { let h=(q.log_first+q.log_step*i as f64).exp(); let v=q.virgin(h);
        cs[i]=virgin_yield_coefficient(&q,&v);
        let n=q.table[i][4]; let start=n*q.friction*v.point.f_n_slip/v.point.delta_t_slip;
        if p.table[i][7]<start.ln() { p.table[i][7]=start.ln(); } }
    for i in 0..KNOTS { p.table[i][4]=cs[i]; }
    if let Some(f)=file { if let Ok(t)=fs::read_to_string(f) {
        let hc:Vec<[f64;2]>=t.lines().map(|l|{let v:Vec<f64>=l.split_whitespace().map(|x|x.parse().unwrap()).collect();[v[0].ln(),v[1]]}).collect();
        set_c(p,&q,&hc); } }
}
fn fit_c(p:&ContactParameters, f:&str, d:&str) {
    let one=&paths(&format!("/tmp/h13/oblcsv/{f}.csv"))[0]; let mu=p.friction;
    let first=one.rows.iter().position(|r|r[3]/r[2]<0.97*mu).unwrap_or(one.rows.len()-4).min(one.rows.len()-4);
    let (x0,x1)=(one.rows[first][0].ln(),one.rows.last().unwrap()[0].ln()); let n=5;
    let mut hc:Vec<[f64;2]>=(0..n).map(|k|{let x=x0+(x1-x0)*k as f64/(n-1) as f64; let pos=((x-p.log_first)/p.log_step).round() as usize; [x,p.table[pos.min(KNOTS-1)][4].max(0.1)]}).collect();
    let cost=|hc:&[[f64;2]]|->f64 { let mut q=*p; set_c(&mut q,p,hc); let l=drive(&q,&one.rows,32); 
        let mut s=0.0; for (r,l) in one.rows.iter().zip(&l).skip(first) { let e=(l[1]/l[0]-r[3]/r[2])/(r[3]/r[2]); s+=e*e; } 
        for w in hc.windows(3) { let k=(w[0][1]*w[2][1]/(w[1][1]*w[1][1])).ln(); s+=0.03*k*k; } s };
    let mut best=cost(&hc); let mut step=0.4f64;
    while step>0.01 { let mut moved=false;
        for k in 0..=n { for s in [step,-step] { let mut t=hc.clone(); if k<n {t[k][1]*=s.exp();} else {for a in &mut t {a[1]*=s.exp();}} let c=cost(&t); if c<best {best=c;hc=t;moved=true;} } }
        if !moved {step*=0.5;} }
    fs::create_dir_all(d).unwrap();
    fs::write(format!("{d}/{f}.c"),hc.iter().map(|a|format!("{} {}\n",a[0].exp(),a[1])).collect::<String>()).unwrap();
    println!("{f} {:?} cost {best:.4}",hc.iter().map(|a|(a[1]*100.0).round()/100.0).collect::<Vec<_>>());
}
fn energy(p:&ContactParameters, name:&str) {
    let mut worst=0.0f64; let mut wh=String::new(); let h=(p.log_first+p.log_step*127.0).exp(); let mut seed=12345u64; let mut coul=0.0f64; let mut cut=0.0f64;
    let mut rnd=||{ seed^=seed<<13; seed^=seed>>7; seed^=seed<<17; (seed>>11) as f64/(1u64<<53) as f64 };
    for run in 0..60 { let slip=p.virgin(h).point.delta_t_slip; let mut s=ContactState::default(); let mut o=ContactResponse::default(); let mut at=[0.0;3]; let mut through=0.0; let steps=200;
        for leg in 0..12 { let kind=(rnd()*4.0) as usize; let mut t=[h*(0.2+0.8*rnd()),slip*(2.0*rnd()-1.0)*1.5,slip*(2.0*rnd()-1.0)*1.5]; if kind==1 {t[0]=at[0];} if kind==2 {t[1]=at[1];t[2]=at[2];} if kind==3 { t[0]=(at[0]-p.virgin(s.h_max.max(1e-4)).depth*rnd()*1.2).max(0.0);} 
            let from=at; let st=[(t[0]-from[0])/steps as f64,(t[1]-from[1])/steps as f64,(t[2]-from[2])/steps as f64];
            for k in 1..=steps { for i in 0..3 {at[i]=from[i]+st[i]*k as f64;} let e0=p.stored_energy(&s); let (n,a)=p.update(&s,at[0],[st[1],st[2]]); let w=0.5*((o.f_n+a.f_n)*st[0]+(o.f_t[0]+a.f_t[0])*st[1]+(o.f_t[1]+a.f_t[1])*st[2]); let g=p.stored_energy(&n)-e0-w; through+=w.abs(); if g/through>worst {worst=g/through; wh=format!("run {run} leg {leg} k {k} kind {kind} x {:.3}->{:.3} sh {:.3} N {:.4}->{:.4} T {:.4}->{:.4} mu {}",s.x,n.x,n.sheared,o.f_n/p.virgin(h).point.f_n0,a.f_n/p.virgin(h).point.f_n0,o.f_t[0].hypot(o.f_t[1])/p.virgin(h).point.f_n0,a.f_t[0].hypot(a.f_t[1])/p.virgin(h).point.f_n0,p.friction);} coul=coul.max(a.f_t[0].hypot(a.f_t[1])-p.friction*a.f_n); s=n;o=a; } }
        // the last way again with steps cut in ten
    }
    let slip=p.virgin(h).point.delta_t_slip;
    for (a,b) in [(1.0,0.3),(0.5,1.0),(1.0,1.0),(1.0,3.0),(1.0,-2.0)] { for n0 in [500usize] { let go=|n:usize|{ let mut s=ContactState::default(); let mut o=ContactResponse::default(); for k in 1..=n*2 { let t=k as f64/n as f64; let hh=if k<=n {0.5*h*t} else {0.5*h+(t-1.0)*0.5*h*a}; let d=if k<=n {0.0} else if b>0.0 {0.5*h*b/n as f64} else if k%2==0 {-0.5*h*b/n as f64} else {0.0}; let (x,y)=p.update(&s,hh,[d,0.0]); s=x;o=y;} [o.f_n,o.f_t[0]] }; let (u,v)=(go(n0),go(n0*10)); let e=((u[0]-v[0]).abs()/v[0]).max((u[1]-v[1]).abs()/v[0]); cut=cut.max(e); if e>0.01 {println!("   {name} {a} {b} {:?} {:?} rel",u.map(|x|x/p.virgin(h).point.f_n0),v.map(|x|x/p.virgin(h).point.f_n0));} } }
    println!("{name:<20} gain {worst:.1e} coulomb {coul:.1e} cut {:.4}  {wh}",cut);
}
