//! Every public type can be printed, copied and compared; kept with `serde` and logged with `defmt`.

use core::fmt::Debug;

use double_pendulum::extrapolation::Extrapolation;
use double_pendulum::flips::*;
use double_pendulum::form::*;
use double_pendulum::plan::*;
use double_pendulum::trig::*;
use double_pendulum::*;

#[cfg(not(feature = "serde"))]
trait Kept {}
#[cfg(not(feature = "serde"))]
impl<T> Kept for T {}
#[cfg(feature = "serde")]
trait Kept: serde::Serialize + serde::de::DeserializeOwned {}
#[cfg(feature = "serde")]
impl<T: serde::Serialize + serde::de::DeserializeOwned> Kept for T {}

#[cfg(not(feature = "defmt"))]
trait Logged {}
#[cfg(not(feature = "defmt"))]
impl<T> Logged for T {}
#[cfg(feature = "defmt")]
use defmt::Format as Logged;

/// The compiler refuses a type that lacks a trait; the path of one that has all.
fn path<T: Debug + Copy + PartialEq + Kept + Logged>() -> &'static str {
    core::any::type_name::<T>()
}

macro_rules! paths {
    ($($type:ty),* $(,)?) => { [$(path::<$type>()),*] };
}

#[test]
fn every_public_type_has_the_common_traits() {
    let with = paths![
        AngleForm<f32>, AngleState<f32, Plain>, Bounds<f64>, Budget, Compensated<f32>, Costs, DirectionForm8<f64>,
        DirectionForm<f32>, DirectionState<f32, Plain>,
        Divided, EqualRods<f64>, Error, ErrorEstimate, ExtrapolatedForm<12>, Extrapolation<f64>, Fixed32Form, Fixed32State,
        Fixed64Form<12>, Fixed64State, Followed, Falling<DirectionState<f32, Plain>, f32>, Flip<f32>, Flips<f32, DirectionForm<f32, Plain>>, Interpolation<f32>, Lanes<f32, 4>, Libm, Limit, Method, Mode<f32>,
        Modes<f32>, Motion<f32>, Node<f32>, Oscillation<f32>, Own, Parameter, Parameters<f32>, Pendulum<f32>, Plain, Plan,
        PlanError, Problem, Quantity, RestoreError, Search, ShadowedRun<f32, DirectionForm<f32>>, SmallOscillations<f32>, State<f32>,
        Stepper<f32, DirectionForm<f32>>, Units<f32>, UnwrappedStepper<f32, DirectionForm<f32>>, Vector<f32>, Way, WayStepper,
        Winding<f32>,
    ];
    let name = |path: &'static str| path.split('<').next().and_then(|path| path.rsplit("::").next()).unwrap_or(path);
    let with = with.map(name);
    let public = include_str!("../public-api.txt").lines().filter_map(|line| {
        let line = line.trim_start_matches("#[non_exhaustive] ");
        let path = line.strip_prefix("pub struct ").or(line.strip_prefix("pub enum "))?;
        path.split(['<', '(']).next().and_then(|path| path.rsplit("::").next())
    });
    let without: Vec<_> = public.filter(|name| !with.contains(name) && *name != "Micromath").collect();
    assert!(without.is_empty(), "the list above lacks {without:?}");
}
