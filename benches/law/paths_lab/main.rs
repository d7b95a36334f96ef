#![allow(non_snake_case, static_mut_refs)]
mod knob;
#[path = "m_update.rs"] mod update;
#[path = "m_virgin.rs"] mod virgin;
#[path = "m_shapes.rs"] mod shapes;
#[path = "m_curve.rs"] mod curve;
use update::*; use virgin::*;
use std::collections::BTreeMap;
use std::fs;

struct Rows { name: String, rows: Vec<[f64;4]>, seg: Vec<usize> }

fn load(path: &str) -> ContactParameters {
    let t = fs::read_to_string(path).unwrap();
    let mut w = t.split_whitespace();
    let mut num: BTreeMap<String,f64> = BTreeMap::new();
    w.next(); w.next(); w.next(); w.next();
    let mut nums: Vec<f64> = vec![];
    loop { let k = w.next().unwrap(); if k=="knots" {break;} num.insert(k.into(), w.next().unwrap().parse().unwrap()); }
    for x in w { if let Ok(v)=x.parse::<f64>() { nums.push(v); } }
    let order=[0usize,1,3,7,2,4,5,6];
    let mut table=[[0.0;COLUMNS];KNOTS];
    for i in 0..KNOTS { for k in 0..COLUMNS { let c=order[k]; let v=nums[i*32+k];
        table[i][c] = if c==1||c==3 { -v.ln() } else if k<4 { v.ln() } else { v }; } }
    let mut shapes=[[[0.0;POINTS];2];LEVELS];
    let mut at=KNOTS*32;
    for i in 0..LEVELS { for k in 0..2 { for j in 0..POINTS { shapes[i][k][j]=nums[at]; at+=1; } } }
    ContactParameters{ radius:num["effective_radius"], effective_modulus:num["effective_modulus"], friction:num["friction"], form:num["form"], log_first:num["first"].ln(), log_step:num["log_step"], gentle:num["gentle"], table, shapes }
}
fn paths(path:&str)->Vec<Rows>{
    let t=fs::read_to_string(path).unwrap(); let mut out:Vec<Rows>=vec![];
    for l in t.lines().skip(1){ let (name,rest)= if l.starts_with('"'){ let e=l[1..].find('"').unwrap(); (l[1..1+e].to_string(), &l[e+3..]) } else { l.split_once(',').unwrap().into_t() };
        let v:Vec<f64>=rest.split(',').map(|x|x.parse().unwrap()).collect();
        if out.last().map_or(true,|o|o.name!=name){ out.push(Rows{name:name.clone(),rows:vec![],seg:vec![]}); }
        let o=out.last_mut().unwrap(); o.seg.push(v[0] as usize); o.rows.push([v[1],v[2],v[3],v[4]]); }
    out
}
trait IntoT<'a>{fn into_t(self)->(String,&'a str);} impl<'a> IntoT<'a> for (&'a str,&'a str){fn into_t(self)->(String,&'a str){(self.0.to_string(),self.1)}}
fn drive(p:&ContactParameters, rows:&[[f64;4]], inc:usize)->Vec<[f64;2]>{
    let mut s=ContactState::default(); let (mut h0,mut d0)=(0.0,0.0); let mut out=vec![];
    for r in rows { let (h,d)=(r[0],r[1]); let mut o=ContactResponse::default();
        for k in 1..=inc { let (n,q)=p.update(&s,h0+(h-h0)*k as f64/inc as f64,[(d-d0)/inc as f64,0.0]); s=n;o=q; }
        if std::env::var("DBG").is_ok() { let v=p.virgin(s.h_max); println!("dbg h {:.5} d {:.5} N/F0 {:.4} r/mu {:.3} x {:.3} sh {:.3}",h,d,o.f_n/v.point.f_n0,o.f_t[0]/o.f_n.max(1e-30)/p.friction,s.x,s.sheared); }
        out.push([o.f_n,o.f_t[0]]); h0=h; d0=d; }
    out
}
fn errors(rows:&[[f64;4]],law:&[[f64;2]])->[[f64;3];2]{
    let normal=rows.iter().map(|r|r[2]).fold(0.0,f64::max);
    [(3usize,1usize),(2,0)].map(|(f,c)|{ let peak=rows.iter().map(|r|r[f].abs()).fold(0.01*normal,f64::max);
        let e:Vec<f64>=rows.iter().zip(law).map(|(r,l)|(l[c]-r[f])/peak).collect();
        let mut w=0; for i in 0..e.len(){ if e[i].abs()>e[w].abs(){w=i;} }
        [ (e.iter().map(|x|x*x).sum::<f64>()/e.len() as f64).sqrt(), e[w].abs(), w as f64 ] })
}
fn main(){
    let a:Vec<String>=std::env::args().collect(); if a.len()==4 && a[1]=="dump" { dump(&a[2],&a[3]); return; }
    let args:Vec<String>=std::env::args().skip(1).collect();
    let mut files=vec![]; let mut detail=false; let mut curves:Option<String>=None; let mut inc=64; let mut cdir:Option<String>=None; let mut only=String::new(); let mut fit:Option<String>=None;
    for a in &args { if let Some((k,v))=a.split_once('='){ match k { "inc"=>inc=v.parse().unwrap(), "curves"=>curves=Some(v.into()), "c"=>cdir=Some(v.into()), "only"=>only=v.into(), "fit"=>fit=Some(v.into()), _=>knob::set(k,v.parse().unwrap()) } } else if a=="-v" {detail=true} else {files.push(a.clone())} }
    let (mut count,mut within)=(0,0); let mut sq=vec![]; let mut g=[0.0f64;2]; let mut sum=[0.0f64;2]; let mut excess=0.0;
    let mut by:BTreeMap<String,(usize,usize,f64)>=BTreeMap::new();
    for f in files {
        let mut p=load(&format!("/tmp/h13/exp/{f}/law.asperity"));
        let mu=p.friction;
        // closed c or the given one in column 4, and the bound of k_T with it
        prepare(&mut p, cdir.as_ref().map(|d|format!("{d}/{f}.c")).as_deref());
        if fit.as_deref()==Some("energy") { energy(&p,&f); continue; }
        if let Some(d)=&fit { fit_c(&p,&f,d); continue; }
        for one in paths(&format!("/tmp/h13/csv/{f}.csv")) {
            if !only.is_empty() && !one.name.contains(&only) {continue;}
            let law=drive(&p,&one.rows,inc); let e=errors(&one.rows,&law);
            let ok=e.iter().all(|x|x[0]<=0.05&&x[1]<=0.12);
            count+=1; within+=ok as usize; sq.push(e[0][0]*e[0][0]); for i in 0..2 {g[i]=g[i].max(e[i][0]);sum[i]+=e[i][0];}
            for x in &e { excess += (x[0]/0.05-1.0).max(0.0)+(x[1]/0.12-1.0).max(0.0); }
            let b=by.entry(one.name.clone()).or_default(); b.0+=1;b.1+=ok as usize;b.2+=e[0][0];
            if detail { let at=|w:f64|{let i=w as usize; let n=one.rows.len(); format!("{}/{} seg {} h {:.4} d {:.5}",i+1,n,one.seg[i],one.rows[i][0],one.rows[i][1])};
                println!("{:<18} {:<29}{} T {:5.1} {:5.1}  N {:5.1} {:5.1}  T@{}  N@{}",f,one.name,if ok {' '} else {'*'},100.*e[0][0],100.*e[0][1],100.*e[1][0],100.*e[1][1],at(e[0][2]),at(e[1][2])); }
            if let Some(d)=&curves { let mut t=String::from("seg,h,d,FN,FT,lN,lT\n"); for (i,r) in one.rows.iter().enumerate(){ t+=&format!("{},{:e},{:e},{:e},{:e},{:e},{:e}\n",one.seg[i],r[0],r[1],r[2],r[3],law[i][0],law[i][1]); }
                fs::create_dir_all(d).unwrap(); fs::write(format!("{d}/{f}-{}.csv",one.name.replace(|c:char|!c.is_alphanumeric(),"-")),t).unwrap(); }
        }
        let _=mu;
    }
    if fit.is_none() {
    if detail { for (k,v) in by { println!("{k:<30} {} of {}  mean rms T {:.2}",v.1,v.0,100.*v.2/v.0 as f64); } }
    println!("{within}/{count} T rms {:.2} mean T {:.2} mean N {:.2} greatest {:.1} {:.1} excess {:.2}",100.*(sq.iter().sum::<f64>()/sq.len() as f64).sqrt(),100.*sum[0]/count as f64,100.*sum[1]/count as f64,100.*g[0],100.*g[1],excess);
    }
}
include!("prepare.rs");

fn dump(law:&str,path:&str){ let p=load(law); let mut s=ContactState::default(); for l in fs::read_to_string(path).unwrap().lines(){ let v:Vec<f64>=l.split_whitespace().map(|x|x.parse().unwrap()).collect(); let (n,o)=p.update(&s,v[0],[v[1],v[2]]); s=n; println!("{:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e} {:e}",o.f_n,o.f_t[0],o.f_t[1],o.df_t_ddelta[0][0],o.df_t_ddelta[0][1],o.df_t_ddelta[1][0],o.df_t_ddelta[1][1],o.df_n_dh,o.df_n_ddelta[0],o.df_n_ddelta[1],s.x,s.sheared);}}
