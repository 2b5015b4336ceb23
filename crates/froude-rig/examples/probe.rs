use froude_rig::*; use froude_rig::load::*; use froude_rig::defaults::*;
use froude_control::request::*;
fn main(){
  for mounting in [Mounting::None, Mounting::Dry, Mounting::Wet] {
    let load=Load::mounted(mounting);
    let c=control_config(&[load,load]);
    println!("{mounting:?} gains {:?} {:?} mode {} {} z {}", c.axes[0].gains, c.axes[1].gains, c.axes[0].mode_hz, c.axes[1].mode_hz, c.axes[0].mode_damping);
    let mut l = match ClosedLoop::new(&TwinConfig::loaded(load), c, 1){Ok(l)=>l,Err(e)=>{println!("{e}");continue}};
    println!("home {} t={} {:?} pos {} {}", l.home(), l.twin.time_s(), l.output.status.fault, l.output.status.axes[0].position_m-l.twin.truth(0).motor_position_m, l.output.status.axes[0].position_m);
    for shaped in [false,true] { for v in [0.05,0.15,0.25,0.35,0.45,0.55] {
      let start = l.output.status.axes[0].position_m; let target = if start>2.0 {1.1} else {3.3};
      let a=(v/0.7_f64).max(0.2);
      l.request(Request::Move{axis:0,profile:Move{target_m:target,speed_m_s:v,acceleration_m_s2:a,jerk_m_s3:a/0.2,is_shaped:shaped}});
      l.step(); if l.output.status.refusal.is_some(){println!("{v} refused {:?}",l.output.status.refusal);continue;}
      let (mut n,mut pe,mut ve0,mut ve1,mut peak,mut rip,mut t0)=(0.0,0.0,None,0.0,0.0f64,0.0f64,None);
      let mut volt=(f64::MAX,f64::MIN);
      while l.output.status.axes[0].phase as u8==2 {
        l.step(); let s=&l.output.status.axes[0]; let e=s.reference_m-s.position_m; peak=peak.max(e.abs());
        if (s.reference_m_s.abs()-v).abs()<1e-9 { let t=*t0.get_or_insert(l.twin.time_s()); 
          rip=rip.max((l.twin.truth(0).load_speed_m_s.abs()-v).abs());
          if l.twin.time_s()-t>0.5 {n+=1.0;pe+=e.abs(); ve0.get_or_insert(e); ve1=e; let u=l.output.command.axes[0].volts; volt=(volt.0.min(u),volt.1.max(u));}}
      }
      println!("{v} shaped {shaped} n {n} mean|e| {:.4} mm  mean ve {:.5} mm/s peak {:.4} mm ripple {:.3} mm/s volts {volt:?} {:?}", pe/n*1e3, (ve1-ve0.unwrap_or(0.0))/(n*250e-6)*1e3, peak*1e3, rip*1e3, l.output.status.fault);
      for _ in 0..4000 {l.step();}
    } }
  }
}
