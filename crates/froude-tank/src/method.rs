//! A method of the tank by its parts.

use froude_identify::method::{Declares, Export, Found, Method, MethodError, Need, Prospect};
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Source};

/// What a method of the tank is called, what it needs, and what does it.
#[derive(Debug)]
pub struct TankMethod {
    /// Names that a campaign selects it by.
    pub names: &'static [&'static str],
    /// What each of them does, one text per name.
    pub words: &'static [&'static str],
    /// Files that it needs.
    pub needs: &'static [Need],
    /// The method that runs must be of.
    pub runs: &'static str,
    /// See [`Method::takes`].
    pub takes: &'static [&'static str],
    /// See [`Method::identify`].
    pub identify: fn(&Campaign, &Source, &[&'static str], &dyn Fn(&str)) -> Result<Found, MethodError>,
    /// See [`Method::simulate`].
    pub simulate: fn(&Campaign, &Source) -> Result<Vec<Export>, MethodError>,
    /// See [`Method::plan`].
    pub plan: fn(&Campaign, &Source) -> Result<Prospect, MethodError>,
    /// See [`Method::declares`].
    pub declares: Declares,
    /// See [`Method::check`].
    pub check: fn(&Source) -> Result<(), RecordError>,
}

impl Method for TankMethod {
    fn names(&self) -> &'static [&'static str] {
        self.names
    }

    fn words(&self, name: &str) -> &'static str {
        self.names.iter().zip(self.words).find(|(own, _)| **own == name).map_or("", |(_, words)| words)
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        self.needs
    }

    fn runs(&self) -> &'static str {
        self.runs
    }

    fn takes(&self) -> &'static [&'static str] {
        self.takes
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        asked: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        (self.identify)(campaign, source, asked, progress)
    }

    fn simulate(&self, campaign: &Campaign, source: &Source) -> Result<Option<Vec<Export>>, MethodError> {
        (self.simulate)(campaign, source).map(Some)
    }

    fn plan(&self, campaign: &Campaign, source: &Source) -> Result<Option<Prospect>, MethodError> {
        (self.plan)(campaign, source).map(Some)
    }

    fn declares(&self) -> Option<Declares> {
        Some(self.declares)
    }

    fn check(&self, source: &Source) -> Result<(), RecordError> {
        (self.check)(source)
    }
}
