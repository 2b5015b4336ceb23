//! When a campaign that stops by its own rule will stop, before the tank is paid for.
//!
//! The rule is played with drawn campaigns. Each lifts and lowers its known weights: the command is s v_c = (f + s W + λ W)/k with the scatter of the friction,
//! and a loss λ of the pulley drawn from its declared uncertainty; they give a force per volt as those of a driven campaign do. Then one pair after the other gives its
//! differences at every speed, and [`OnLine`] looks at them as it does on the rig.
//!
//! **Scatter.** A difference scatters as declared (`expected_scatter`, which `froude carriage drag` prints after every campaign), drawn anew for each campaign with its degrees of
//! freedom, s √(ν/χ²_ν); where nothing is declared, friction is taken to repeat within 2 %. The drift of K_T comes on top, in proportion to the drag.
//!
//! **Floor.** Errors that all pairs share (force per volt, encoder, pulley) do not average out: the half-width never falls below the longer arm of their own interval at 1 − 0.05/n,
//! n planned looks. More planned pairs raise it.
//!
//! Not drawn: changes that a whole pair shares beyond friction, and what an operator does.

use rand::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use froude_records::block::{Block, Section, TableBuilder, facts};
use froude_records::number::{percent, significant};
use froude_records::run::{Direction, Role};
use froude_rig::campaign::preflight::Objection;
use froude_rig::campaign::prepare::Prepared;
use froude_rig::carriage::plan::PlannedRun;
use froude_rig::carriage::{Directions, DrivenCampaign};

use crate::drag::calibration::Readings;
use crate::drag::detectability::DryMean;
use crate::drag::online::{FEWEST_PAIRS, OnLine, Status};
use crate::drag::point::Point;
use crate::drag::setup::DragSetup;
use crate::live::setup_before;
use crate::reduction::{calibration_from, known_of_calibration, pulley_loss};

/// Drawn campaigns: a probability of 90 % then has a standard deviation of 2 %.
const DRAWS: u64 = 200;

/// Most planned pairs that are played: a look costs the square of its pairs, and 40 take some three seconds.
const MOST_PLANNED: usize = 40;

/// What a campaign is expected to show.
#[derive(Debug, Clone)]
struct Asked {
    /// The campaign, for what it declares of weights and pulley.
    campaign: Option<DrivenCampaign>,
    /// What is known before the first run; its looks are the planned pairs.
    setup: DragSetup,
    /// Relative half-width to reach.
    target_relative: f64,
    /// D_d to be expected, N s²/m².
    drag_n_s2_m2: f64,
    /// Friction of the carriage, N.
    friction_n: f64,
    /// Standard deviation of one wet − dry difference, N, and its degrees of freedom.
    scatter_n: (f64, f64),
    /// Signed speeds of the differences of one pair, m/s.
    velocity_m_s: Vec<f64>,
    /// Direction and weight, N, of each calibration run.
    weights: Vec<(f64, f64)>,
}

impl Asked {
    /// Of a campaign that stops by itself and declares the drag to expect.
    fn of(prepared: &Prepared) -> Option<Self> {
        let plan = prepared.asked();
        let campaign = DrivenCampaign {
            campaign: prepared.campaign().clone(),
            carriage: Some(prepared.carriage().clone()),
            logs: None,
        };
        let is_both = plan.directions == Directions::Both;
        let ways: &[f64] = if is_both { &[1.0, -1.0] } else { &[1.0] };
        let sign = |run: &PlannedRun| run.direction().map(Direction::sign);
        let weighed = prepared.runs().filter(|run| run.role == Role::Calibration);
        Some(Self {
            setup: setup_before(&campaign, plan),
            target_relative: plan.stop_at_relative_half_width?,
            drag_n_s2_m2: plan.expected_drag_n_s2_m2?,
            friction_n: prepared.friction_n(),
            scatter_n: prepared.scatter_n(),
            velocity_m_s: plan.speed_m_s.iter().flat_map(|v| ways.iter().map(move |way| way * v)).collect(),
            weights: weighed.filter_map(|run| Some((sign(run)?, run.hung_weight_n))).collect(),
            campaign: Some(campaign),
        })
    }
}

/// A drawn campaign.
struct Drawn<'a> {
    asked: &'a Asked,
    live: OnLine,
    setup: DragSetup,
    rng: Pcg64Mcg,
    /// Standard deviation of the friction of one run, N.
    of_run_n: f64,
    /// By how much the encoder is wrong, as a part.
    speed_scale: f64,
    pairs: u32,
}

impl<'a> Drawn<'a> {
    /// With its weights lifted and no pair driven yet.
    fn new(asked: &'a Asked, seed: u64) -> Self {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let k = asked.setup.force_per_volt_n();
        let known = known_of_calibration(asked.campaign.as_ref(), None);
        let loss = pulley_loss(asked.campaign.as_ref());
        let loss = (loss.value + loss.standard * normal()).max(0.0);
        let of_weights = 1.0 + known.weight_relative * normal();
        let speed_scale = asked.setup.speed_scale_relative * normal();
        let (scatter_n, dof) = asked.scatter_n;
        let chance = if dof.is_finite() {
            ChiSquared::new(dof).map_or(1.0, |chi_squared| (dof / chi_squared.sample(&mut rng)).sqrt())
        } else {
            1.0
        };
        let of_run_n = chance * scatter_n / std::f64::consts::SQRT_2;
        let mut readings = Readings::default();
        for &(direction, weight_n) in &asked.weights {
            let [chance, drift]: [f64; 2] = [(); 2].map(|()| StandardNormal.sample(&mut rng));
            let hung_n = of_weights * weight_n * (1.0 + asked.setup.torque_constant_drift_relative * drift);
            let along_n = asked.friction_n + direction * hung_n + loss * hung_n + of_run_n * chance;
            readings.push_drawn(direction, weight_n, along_n / k);
        }
        let (calibration, _) = calibration_from(&readings, asked.campaign.as_ref(), &asked.setup);
        let calibration = calibration.map(|c| c.force_per_volt).or(asked.setup.calibration);
        let per_pair = asked.velocity_m_s.iter().filter(|v| v.abs() == asked.velocity_m_s[0].abs()).count();
        Self {
            live: OnLine::new(asked.target_relative, per_pair),
            setup: DragSetup { calibration, ..asked.setup.clone() },
            asked,
            rng,
            of_run_n,
            speed_scale,
            pairs: 0,
        }
    }

    /// One pair more.
    fn drive(&mut self) {
        self.pairs += 1;
        // What a volt is, and what it is taken for.
        let (k, taken) = (self.asked.setup.force_per_volt_n(), self.setup.force_per_volt_n());
        for &v in &self.asked.velocity_m_s {
            let mut normal = || -> f64 { StandardNormal.sample(&mut self.rng) };
            // The points lose the declared drag of the strut again.
            let strut = self.setup.strut_n_s2_m2.map_or(0.0, |strut| strut.value);
            let drag_n = (self.asked.drag_n_s2_m2 + strut)
                * v
                * v
                * (1.0 + self.setup.torque_constant_drift_relative * normal());
            let dry_n = self.asked.friction_n + self.of_run_n * normal();
            let wet_n = self.asked.friction_n + self.of_run_n * normal() + drag_n;
            self.live.push_dry(DryMean { velocity_m_s: v, pair: self.pairs, resistance_v: dry_n / k });
            self.live.push(Point {
                run: String::new(),
                speed_m_s: v * (1.0 + self.speed_scale),
                force_n: v.signum() * (wet_n - dry_n) * taken / k,
                standard_n: self.of_run_n,
                effective_n: 10.0,
                pair: self.pairs,
                position_m: [0.0, 1.0],
                trend_n: None,
            });
        }
    }

    /// Where its estimate stands.
    fn look(&self) -> Option<Status> {
        self.live.status(&self.setup)
    }
}

/// When a campaign stops.
#[derive(Debug, Clone, PartialEq)]
struct Forecast {
    /// Pairs at which the drawn campaigns stop, increasing; `None` for those that do not within the plan.
    stops: Vec<Option<usize>>,
    /// Relative half-widths that no number of pairs goes below, increasing; one of each campaign.
    floors: Vec<f64>,
}

impl Forecast {
    /// Plays the rule.
    fn of(asked: &Asked) -> Self {
        let mut stops: Vec<Option<usize>> = (0..DRAWS).into_par_iter().map(|seed| played(asked, seed)).collect();
        stops.sort_by_key(|stop| stop.unwrap_or(usize::MAX));
        Self { stops, floors: floors(asked) }
    }

    /// Relative half-width that half of the campaigns cannot go below.
    fn floor_relative(&self) -> f64 {
        self.floors[self.floors.len() / 2]
    }

    /// Pairs after which this part of the campaigns has stopped; `None` beyond the plan.
    fn quantile(&self, part: f64) -> Option<usize> {
        let rank = (part * self.stops.len() as f64).ceil() as usize;
        self.stops.get(rank.saturating_sub(1)).copied().flatten()
    }

    /// Part of the campaigns that reach the target within the plan.
    fn reached(&self) -> f64 {
        self.stops.iter().flatten().count() as f64 / self.stops.len() as f64
    }
}

/// When a drawn campaign stops.
fn played(asked: &Asked, seed: u64) -> Option<usize> {
    let mut drawn = Drawn::new(asked, seed);
    (1..=asked.setup.looks).find(|pair| {
        drawn.drive();
        *pair >= FEWEST_PAIRS && drawn.look().is_some_and(|status| status.may_stop)
    })
}

/// What the errors that all pairs share leave, as part of D_d, in each drawn campaign; increasing.
fn floors(asked: &Asked) -> Vec<f64> {
    let of = |seed| {
        let mut drawn = Drawn::new(asked, seed);
        (0..FEWEST_PAIRS).for_each(|_| drawn.drive());
        drawn.look().map(|status| status.floor / status.value.abs())
    };
    let mut floors: Vec<f64> = (0..DRAWS).into_par_iter().map(|seed| of(seed).unwrap_or(0.0)).collect();
    floors.sort_by(f64::total_cmp);
    floors
}

/// Adds to a campaign that stops by itself when that is to be expected, and refuses a target that no number of pairs reaches.
pub fn foresee(prepared: &mut Prepared) {
    let plan = prepared.asked();
    let Some(target) = plan.stop_at_relative_half_width else { return };
    let (planned, asked) = (plan.repeats, Asked::of(prepared));
    let mut say = |said: String| prepared.beside.push(Block::text("", vec![said]));
    if planned < FEWEST_PAIRS {
        return say(format!(
            "stop_when never ends this campaign: the interval is evaluated after whole pairs, from the third on, and {planned} are planned."
        ));
    }
    let Some(asked) = asked else {
        return say("When stop_when ends the campaign cannot be forecast: expected_drag is not declared.".to_owned());
    };
    let lowest = floors(&asked)[0];
    if target <= lowest {
        return refuse(
            prepared,
            format!(
                "stop_when = {} cannot be reached: the errors that all pairs share (force per volt, encoder) alone give ± {} at least (95 %, {planned} planned looks). Write a larger target, plan fewer pairs, \
                 or calibrate better (pulley, weights)",
                percent(target),
                percent(lowest)
            ),
        );
    }
    if planned > MOST_PLANNED {
        return say(format!(
            "When stop_when ends the campaign is forecast for up to {MOST_PLANNED} planned pairs; {planned} are planned."
        ));
    }
    let section = section(&Forecast::of(&asked), &asked, prepared);
    prepared.beside.push(section.into());
}

fn refuse(prepared: &mut Prepared, text: String) {
    prepared.objections.push(Objection { id: "[carriage]".to_owned(), kind: "stop", text });
}

/// Parts of the campaigns that the table states.
const PARTS: [(&str, f64); 3] = [("10 %", 0.1), ("half", 0.5), ("90 %", 0.9)];

fn section(forecast: &Forecast, asked: &Asked, prepared: &Prepared) -> Section {
    let planned = asked.setup.looks;
    let t = TableBuilder::new("stop", "When stop_when ends the campaign", &PARTS);
    let pairs = |(_, part): &(&str, f64)| forecast.quantile(*part);
    let table = t.build(vec![
        t.text("campaigns", "of campaigns like it", |(name, _)| (*name).to_owned()),
        t.number("pairs", "stop after pairs", |row| pairs(row).map(|pairs| pairs as f64)).places(0),
        t.number("duration_s", "time on the rig [s]", |row| {
            pairs(row).map(|pairs| prepared.duration_of_pairs_s(pairs))
        })
        .places(0),
    ]);
    let f = facts("", "", forecast);
    let about = f.build(vec![
        f.number("reached", "", Forecast::reached),
        f.number("floor_relative", "", Forecast::floor_relative),
        f.number("scatter_n", "", |_| asked.scatter_n.0),
    ]);
    let (scatter_n, dof) = asked.scatter_n;
    let whence = if dof.is_finite() {
        format!("declared, {} degrees of freedom", significant(dof, 3))
    } else {
        "assumed; declare what froude carriage drag prints of an earlier campaign as expected_scatter".to_owned()
    };
    let said = vec![format!(
        "In {} of {DRAWS} drawn campaigns the 95 % interval narrows to ± {} within the {planned} planned pairs (—: not within them). One wet-minus-dry difference scatters by {} N ({whence}), drawn as independent \
         from run to run: where mounting changes the friction of a whole pair, more pairs are needed. The errors that all pairs share alone give ± {}.",
        percent(forecast.reached()),
        percent(asked.target_relative),
        significant(scatter_n, 2),
        percent(forecast.floor_relative())
    )];
    Section {
        key: "stop_forecast".to_owned(),
        blocks: vec![about.into(), table.into(), Block::text("", said)],
        ..Section::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drag::setup::Efficiency;
    use froude_fit::budget::Uncertain;

    /// Six speeds out and back at 0.06 N a difference, and an efficiency that is known to this part.
    fn asked(planned: usize, target_relative: f64, shared: f64, dof: f64) -> Asked {
        let efficiency = Efficiency::Declared(Uncertain::new(0.8, 0.8 * shared));
        let speeds = [0.05, 0.15, 0.25, 0.35, 0.45, 0.55];
        Asked {
            campaign: None,
            setup: DragSetup {
                looks: planned,
                efficiency,
                torque_constant_relative: 0.0,
                torque_constant_drift_relative: 0.0,
                speed_scale_relative: 0.0,
                ..DragSetup::of_the_paper()
            },
            target_relative,
            drag_n_s2_m2: 20.0,
            friction_n: 2.85,
            scatter_n: (0.06, dof),
            velocity_m_s: speeds.iter().flat_map(|v| [*v, -v]).collect(),
            weights: Vec::new(),
        }
    }

    /// When a campaign stops, and whether the interval that it then states covers.
    fn outcome(asked: &Asked, planned: usize, seed: u64) -> (Option<usize>, bool) {
        let mut drawn = Drawn::new(asked, 1_000_000 + seed);
        let mut last = None;
        for pair in 1..=planned {
            drawn.drive();
            last = drawn.look().filter(|status| status.half_width.is_some()).or(last);
            if let Some(status) = last.filter(|status| status.may_stop) {
                return (Some(pair), covers(&status, asked));
            }
        }
        (None, last.is_some_and(|status| covers(&status, asked)))
    }

    fn seeds() -> u64 {
        std::env::var("FROUDE_SEEDS").ok().and_then(|n| n.parse().ok()).unwrap_or(200)
    }

    /// As many as tell 91 % from 95 %.
    const SEEDS_OF_COVERAGE: u64 = 2_000;

    fn outcomes(asked: &Asked, planned: usize) -> Vec<(Option<usize>, bool)> {
        (0..seeds()).into_par_iter().map(|seed| outcome(asked, planned, seed)).collect()
    }

    fn covers(status: &Status, asked: &Asked) -> bool {
        (status.value - asked.drag_n_s2_m2).abs() <= status.half_width.unwrap()
    }

    #[test]
    fn a_target_is_reached_where_the_forecast_says_and_not_below_its_floor() {
        let reached = Forecast::of(&asked(10, 0.03, 0.004, f64::INFINITY));
        assert!(reached.reached() > 0.95 && reached.quantile(0.1) <= reached.quantile(0.9), "{reached:?}");
        // z(1 − 0.05/10) = 2.807.
        assert!((reached.floor_relative() - 2.807 * 0.004).abs() < 1e-4, "{}", reached.floor_relative());
        let below = Forecast::of(&asked(10, 0.01, 0.004, f64::INFINITY));
        assert!(below.reached() == 0.0 && below.quantile(0.5).is_none(), "{below:?}");
        // More planned pairs are more looks.
        assert!(Forecast::of(&asked(40, 0.01, 0.004, f64::INFINITY)).floor_relative() > reached.floor_relative());
    }

    /// Campaigns stop within the stated range, and their intervals cover although chance chose when.
    #[test]
    fn campaigns_stop_when_the_forecast_says() {
        for (planned, target) in [(20, 0.012), (20, 0.008), (20, 0.006), (40, 0.0125), (40, 0.008), (40, 0.006)] {
            let truth = asked(planned, target, 0.0, f64::INFINITY);
            let forecast = Forecast::of(&truth);
            let middle = forecast.quantile(0.5).unwrap();
            let range = forecast.quantile(0.1).unwrap()..=forecast.quantile(0.9).unwrap_or(usize::MAX);
            let mut stops = outcomes(&truth, planned);
            let part = |n: usize| n as f64 / stops.len() as f64;
            let inside = part(stops.iter().filter(|(stop, _)| range.contains(&stop.unwrap_or(usize::MAX))).count());
            let covered = part(stops.iter().filter(|(_, covers)| *covers).count());
            stops.sort_by_key(|(stop, _)| stop.unwrap_or(usize::MAX));
            let found = stops[stops.len() / 2].0.unwrap();
            println!(
                "{planned} pairs, {target}: {range:?}, median {middle}, found {found}; {inside} inside, {covered} cover"
            );
            assert!(found.abs_diff(middle) <= 1, "{found} for {middle}");
            assert!(inside >= 0.74, "{inside}");
            assert!(covered >= 0.94, "{covered}");
        }
    }

    /// An interval that stops a campaign is one that chance made short: with neither the price for its looks nor the dry repeats, which bound the scatter from
    /// below, it covers too seldom; either of them suffices.
    #[test]
    fn looks_that_nothing_pays_for_cover_too_seldom() {
        let paid = Asked { scatter_n: (0.11, f64::INFINITY), ..asked(20, 0.0075, 0.0, f64::INFINITY) };
        let unpaid = Asked { setup: DragSetup { looks: 1, ..paid.setup.clone() }, ..paid.clone() };
        let part = |covers: Vec<bool>| covers.iter().filter(|covers| **covers).count() as f64 / covers.len() as f64;
        let covered = |asked: &Asked| part(outcomes(asked, 20).into_iter().map(|(_, covers)| covers).collect());
        let alone =
            part((0..SEEDS_OF_COVERAGE).into_par_iter().map(|seed| covers_without_dry_runs(&unpaid, seed)).collect());
        let (paid, unpaid) = (covered(&paid), covered(&unpaid));
        println!("{paid} with the looks paid for, {unpaid} with the dry repeats alone, {alone} with neither");
        assert!(paid >= 0.94 && unpaid >= 0.94 && alone < 0.94, "{paid}, {unpaid}, {alone}");
    }

    fn covers_without_dry_runs(asked: &Asked, seed: u64) -> bool {
        let mut drawn = Drawn::new(asked, seed);
        let mut status = None;
        for _ in 1..=20 {
            drawn.drive();
            let mut without = OnLine::new(asked.target_relative, 2);
            drawn.live.points().iter().for_each(|point| without.push(point.clone()));
            status = without.status(&drawn.setup);
            if status.is_some_and(|status| status.may_stop) {
                break;
            }
        }
        status.is_some_and(|status| covers(&status, asked))
    }
}
