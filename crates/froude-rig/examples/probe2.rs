use froude_rig::*; use froude_rig::load::*; use froude_rig::defaults::*;
use froude_control::request::*;
fn main(){
    let load=Load::mounted(Mounting::Dry);
    let mut l = ClosedLoop::new(&TwinConfig::loaded(load), control_config(&[load,load]), 1).unwrap();
    l.step(); l.request(Request::Enable{axis:0}); l.step(); l.request(Request::Home{axis:0});
    let mut k=0;
    for i in 0..100000 { l.step(); let t=l.twin.truth(0); 
      if t.load_position_m<0.0005 { k+=1; if k%20==0 {println!("{:.4} {:?} ref {:.5} pos {:.5} load {:.6} v {:.4} low {} volts {:.3} cur {:.3} spring {:.2} {:?}", l.twin.time_s(), l.output.status.axes[0].phase, l.output.status.axes[0].reference_m,l.output.status.axes[0].position_m,t.load_position_m,t.load_speed_m_s,l.tick.axes[0].is_low_end,l.output.command.axes[0].volts,l.tick.axes[0].current_a,t.spring_n,l.output.status.fault);} if k>2000 || l.output.status.fault.is_some(){break;}}
      let _=i; }
}
