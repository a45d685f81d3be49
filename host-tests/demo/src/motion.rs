//! The options for the user's own motion, which replaces the start of a scene.
//!
//! A number is written as a decimal or a fraction such as `1/2`, and a pair as two numbers with a
//! comma between them, number 1 first. The texts of [`OwnMotion`] are the help of the command; its
//! ranges are checked by [`OwnMotion::settings`].

use std::fmt::Display;

use clap::Args;
use double_pendulum::{Error, Parameter, radians};
use firmware::config::{GREATEST_ANGLE, Processor};
use firmware::graphics::Format;
use firmware::motion::{Resources, Settings};
use firmware::scenes::{AnyScene, SceneName};

use boards::console::cli::{Refused, option_of};
use boards::console::number::{Number, Pair};

/// The pendulum and its start. The scene's value applies where an option is missing.
#[derive(Args, Clone, Debug)]
pub struct OwnMotion {
    /// Masses of the bobs, kg [default: the scene's, like all of these]
    #[arg(long, value_name = "M1,M2", allow_hyphen_values = true)]
    masses: Option<Pair>,
    /// Lengths of the rods, m
    #[arg(long, value_name = "L1,L2", allow_hyphen_values = true)]
    lengths: Option<Pair>,
    /// Gravitational acceleration, m/s^2
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    gravity: Option<Number>,
    /// Angles at the start from hanging, rad (see --degrees), at most half a turn either way
    #[arg(long, value_name = "A1,A2", allow_hyphen_values = true)]
    angles: Option<Pair>,
    /// Angular velocities at the start, rad/s (see --degrees)
    #[arg(long, value_name = "W1,W2", allow_hyphen_values = true)]
    velocities: Option<Pair>,
    /// Read angles in degrees and velocities in degrees per second
    #[arg(long)]
    degrees: bool,
}

const MASSES: &str = "--masses";
const LENGTHS: &str = "--lengths";
const GRAVITY: &str = "--gravity";
const ANGLES: &str = "--angles";
const VELOCITIES: &str = "--velocities";

fn used_by(scene: SceneName) -> &'static [&'static str] {
    match scene {
        SceneName::Frequencies => &[MASSES],
        SceneName::Flips => &[MASSES, LENGTHS, GRAVITY],
        SceneName::Page
        | SceneName::SmallLight
        | SceneName::SmallEqual
        | SceneName::SmallHeavy
        | SceneName::Beats3To2
        | SceneName::Beats2To1
        | SceneName::Beats5To2
        | SceneName::Beats3To1
        | SceneName::Figure7
        | SceneName::Butterfly
        | SceneName::Upright => &[MASSES, LENGTHS, GRAVITY, ANGLES, VELOCITIES],
    }
}

impl OwnMotion {
    fn given(&self) -> Vec<(&'static str, String)> {
        fn text(value: &Option<impl Display>) -> Option<String> {
            value.as_ref().map(ToString::to_string)
        }
        let options = [
            (MASSES, text(&self.masses)),
            (LENGTHS, text(&self.lengths)),
            (GRAVITY, text(&self.gravity)),
            (ANGLES, text(&self.angles)),
            (VELOCITIES, text(&self.velocities)),
        ];
        options
            .into_iter()
            .filter_map(|(option, value)| Some((option, value?)))
            .collect()
    }

    /// Returns the settings to play `scene` with, or `None` if no option is given. Settings have
    /// angles in degrees and velocities in rad/s, whatever the units of the options.
    /// in some scenes, or a motion that is too fast for every method.
    pub fn settings(
        &self,
        scene: SceneName,
        processor: Processor,
    ) -> Result<Option<Settings>, Refused> {
        // An option without effect is an error.
        let given = self.given();
        let used = used_by(scene);
        if let Some((option, value)) = given.iter().find(|(option, _)| !used.contains(option)) {
            return Err(Refused::because(format_args!(
                "{option} {value}: scene {} does not use it; take another scene, as in --scene \
                 page",
                scene.name()
            )));
        }
        if given.is_empty() {
            return Ok(None);
        }

        let settings = self.applied_to(scene.first_settings());
        self.check_angles(&settings)?;

        let resources = Resources {
            processor,
            method: None,
            format: Format::OLED,
        };
        let mut started = AnyScene::empty();
        started
            .start(scene, &settings, &resources)
            .map_err(|error| refusal(&given, scene, &error))?;
        if started.is_too_fast() {
            return Err(too_fast(&all(&given)));
        }
        Ok(Some(settings))
    }

    fn applied_to(&self, mut settings: Settings) -> Settings {
        let parameters = &mut settings.parameters;
        if let Some(masses) = &self.masses {
            [parameters.m1, parameters.m2] = masses.values();
        }
        if let Some(lengths) = &self.lengths {
            [parameters.l1, parameters.l2] = lengths.values();
        }
        if let Some(gravity) = &self.gravity {
            parameters.g = gravity.value();
        }
        if let Some(angles) = &self.angles {
            settings.degrees = angles.values().map(|angle| {
                if self.degrees {
                    angle
                } else {
                    angle.to_degrees()
                }
            });
        }

        if let Some(velocities) = &self.velocities {
            settings.velocities = velocities.values().map(|velocity| {
                if self.degrees {
                    radians(velocity)
                } else {
                    velocity
                }
            });
        }

        settings
    }

    fn check_angles(&self, settings: &Settings) -> Result<(), Refused> {
        let is_beyond = settings
            .degrees
            .iter()
            .any(|degrees| degrees.abs() > GREATEST_ANGLE);
        let Some(angles) = self.angles.as_ref().filter(|_| is_beyond) else {
            return Ok(());
        };
        let limit = if self.degrees {
            format!("at most {GREATEST_ANGLE} degrees either way")
        } else {
            let radians = radians(GREATEST_ANGLE);
            format!("at most {radians:.4} rad either way; if these are degrees, add --degrees")
        };
        Err(Refused::because(format_args!("{ANGLES} {angles}: {limit}")))
    }
}

/// Returns the reason why a scene cannot start.
fn refusal(given: &[(&'static str, String)], scene: SceneName, error: &Error) -> Refused {
    // The refused parameter names the option, if the user has given that option, or else all
    // options.
    let option = option_of(error, "");
    let is_to_blame = |(name, _): &&(&str, String)| *name == option;
    let blamed = match given.iter().find(is_to_blame) {
        Some(blamed) => std::slice::from_ref(blamed),
        None => given,
    };
    let blamed = all(blamed);
    let scene = scene.name();
    match error {
        Error::UnequalRods { .. } => Refused::because(format_args!(
            "{blamed}: scene {scene} needs rods of equal length; take another scene, as in \
             --scene page"
        )),
        _ if error.parameter() == Parameter::Dt => too_fast(&blamed),
        error => Refused::because(format_args!("{blamed}: {error}")),
    }
}

fn all(given: &[(&'static str, String)]) -> String {
    let words = given
        .iter()
        .map(|(option, value)| format!("{option} {value}"));
    words.collect::<Vec<_>>().join(" ")
}

fn too_fast(blamed: &str) -> Refused {
    Refused::because(format_args!(
        "{blamed}: too fast a motion for this chip; take masses more alike, longer rods, less \
         gravity or lower velocities"
    ))
}
