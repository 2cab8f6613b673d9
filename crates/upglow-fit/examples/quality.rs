//! tmp
use upglow::*; use upglow_color::*; use upglow_fit::*;
fn main(){
  let arg: Vec<String> = std::env::args().collect();
  let kind=&arg[1]; let od: Option<f64>=arg.get(2).and_then(|s| s.parse().ok()); let slope: Option<f64>=arg.get(3).and_then(|s| s.parse().ok());
  let sweeps: u32 = arg.get(4).and_then(|s| s.parse().ok()).unwrap_or(2);
  let model=match kind.as_str(){"r"=>Model::Reflectance,"a"=>Model::Analytic(AnalyticModel::default()),s=>Model::Dyes(DyeModel::new(DyeSet::named(s).unwrap(),DyeOptions{optical_density:od,..Default::default()}).unwrap())};
  let t=std::time::Instant::now();
  let c=Contract::default();
  let cube=build_cube(&c,&model,FitOptions{slope_max_per_nm:slope,sweeps,..Default::default()},32,&Unwatched).unwrap();
  let s=CubeSummary::of(&cube);
  let mc: f64 = cube.nodes().iter().map(|n| n.material(cube.model()).fluorescence.concentration()).sum::<f64>()/s.fluorescent.max(1) as f64;
  println!("{kind} od {od:?} slope {slope:?} {:.2}s {s:?} <=1 {:.2}% mean conc {mc:.3}",t.elapsed().as_secs_f64(), s.within_1 as f64/327.68);
}
