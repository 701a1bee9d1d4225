package armcmc.spy.model;

import armcmc.change_t;
import armcmc.data_pack_t;
import armcmc.estimate_t;
import armcmc.estimator_status_t;
import armcmc.plant_truth_t;
import armcmc.posterior_t;
import armcmc.spy.Check;
import armcmc.spy.Messages;

public class ModelTest {
  public void thePosteriorTakesItsNamesFromTheEstimate() {
    PosteriorModel model = new PosteriorModel();
    model.accept(Messages.posterior(7), 1);
    Check.equal("parameter 1", model.parameter(0).label());
    model.accept(Messages.estimate(7), 1);
    Check.equal("K [N/m^p]", model.parameter(0).label());
    Check.near(3.5, model.history(0).newest().mean(), 1e-9);
    Check.near(0.1, model.history(0).newest().sd(), 1e-3);
    Check.equal("contact", model.modeName());
  }

  public void theTruthIsThereOnlyWhenThePlantTellsIt() {
    PosteriorModel model = new PosteriorModel();
    model.accept(Messages.posterior(1), 1);
    Check.that(Double.isNaN(model.truth(0)), "nobody told");
    model.accept(Messages.truth(), 1);
    Check.equal(3.55, model.truth(0));
    Check.that(Double.isNaN(model.truth(2)), "an effect that only the model has");
  }

  public void theTruthOfTheActuatorBelongsToItsMode() {
    Truth truth = new Truth();
    plant_truth_t message = Messages.truth();
    message.plant_kind = data_pack_t.PLANT_SOFT_ACTUATOR;
    message.true_mode = 1;
    truth.accept(message);
    Check.equal(3.55, truth.of(1, 0));
    Check.that(Double.isNaN(truth.of(0, 0)), "the other valve");
    message.true_mode = 99;
    truth.accept(message);
  }

  public void everyModeHasAHistoryOfItsOwn() {
    PosteriorModel model = new PosteriorModel();
    posterior_t p = Messages.posterior(1);
    model.accept(p, 1);
    p.mode = 1;
    model.accept(p, 2);
    Check.equal(1, model.history(0).entries().size());
    p.mode = 0;
    model.accept(p, 3);
    Check.equal(2, model.history(0).entries().size());
  }

  public void theHistoryIsTwentySecondsLong() {
    PosteriorModel model = new PosteriorModel();
    for (int i = 0; i < 600; ++i) model.accept(Messages.posterior(i), 0.1 * i);
    int size = model.history(0).entries().size();
    Check.that(size >= 200 && size <= 202, size + " posteriors in 20 s at 10 Hz");
  }

  public void whatIsNotKnownIsNotShown() {
    PosteriorModel model = new PosteriorModel();
    posterior_t p = Messages.posterior(1);
    p.known = 0;
    model.accept(p, 1);
    Check.that(!model.known() && model.history(0).newest() == null, "nothing is known");
    EstimateModel estimates = new EstimateModel();
    estimate_t e = Messages.estimate(1);
    e.known = 0;
    estimates.accept(e, 1);
    Check.that(Double.isNaN(estimates.band(0).mean.last()), "a zero that is no estimate");
    Check.equal(0, estimates.output().mean.size());
  }

  public void predictionAndMeasurementMeetAtTheSameSample() {
    EstimateModel model = new EstimateModel();
    model.accept(Messages.pack(5), 1);
    model.accept(Messages.estimate(5), 1.01);
    Check.near(model.output().mean.time(0), model.measured().time(model.measured().size() - 1), 0.01);
    Check.equal(5.0, model.output().mean.last());
  }

  public void inFreeMotionTheLastModeStays() {
    EstimateModel model = new EstimateModel();
    estimate_t e = Messages.estimate(1);
    model.accept(e, 1);
    e = Messages.estimate(2);
    e.mode = 1;
    e.in_contact = 0;
    model.accept(e, 1.1);
    Check.equal("contact", model.modeName());
    Check.equal(2, model.band(0).mean.size());
  }

  public void silenceIsNoStepOfNoTime() {
    StatusModel model = new StatusModel();
    model.accept(Messages.status(1), 1);
    estimator_status_t idle = Messages.status(1);
    idle.end_to_end_ns = 0;
    model.accept(idle, 2);
    Check.that(Double.isNaN(model.adjust.last()), "no step, no time");
    Check.near(40, model.adjust.value(0), 1e-9);
  }

  public void aMissIsAnEventOfItsStep() {
    StatusModel model = new StatusModel();
    estimator_status_t s = Messages.status(1);
    s.missed_own = 5;  // of before we looked
    model.accept(s, 1);
    s = Messages.status(2);
    s.missed_own = 6;
    model.accept(s, 1.1);
    Check.equal(0.0, model.ownMisses.value(0));
    Check.equal(1.0, model.ownMisses.value(1));
  }

  public void aFaultStandsLongEnoughToBeRead() {
    StatusModel model = new StatusModel();
    estimator_status_t s = Messages.status(1);
    s.fault_flags = estimator_status_t.FAULT_BAD_DATA;
    model.accept(s, 10);
    model.accept(Messages.status(2), 10.1);
    Check.equal(estimator_status_t.FAULT_BAD_DATA, model.recentFaults(12));
    Check.equal(0, model.recentFaults(13.5));
  }

  public void whatIsBelievedIsThatOfTheReportedMode() {
    StatusModel model = new StatusModel();
    change_t c = Messages.change(1);
    model.accept(c, 1);
    Check.equal(0.625, model.drifted.last());
    c = Messages.change(2);
    c.mode = 1;
    model.accept(c, 1.1);
    Check.that(Double.isNaN(model.drifted.last()), "no probability for a mode that is not known");
  }

  public void everyFlagHasAWord() {
    Check.equal(7, StatusFlags.degraded(127).size());
    Check.equal(11, StatusFlags.faults(2047).size());
    Check.equal("bus flooded", StatusFlags.faults(256).get(0));
    Check.equal("unknown flag 4096", StatusFlags.faults(4096).get(0));
  }

  public void messagesThatMakeNoSenseAreSurvived() {
    PosteriorModel posteriors = new PosteriorModel();
    posterior_t p = Messages.posterior(1);
    p.n_params = 1_000_000;
    p.n_bins = -3;
    p.mode = -7;
    posteriors.accept(p, 1);
    EstimateModel estimates = new EstimateModel();
    estimate_t e = Messages.estimate(1);
    e.n_params = -5;
    e.mode = 1_000;
    estimates.accept(e, 1);
    data_pack_t pack = Messages.pack(1);
    pack.n_samples = 1_000_000;
    pack.dt = Double.NaN;
    estimates.accept(pack, 1);
    Check.equal(0, estimates.count());
  }

  public void freshnessTellsSilenceFromLife() {
    Freshness freshness = new Freshness();
    Check.that(!freshness.any() && !freshness.stale(100), "nothing came yet");
    for (int i = 0; i < 50; ++i) freshness.seen(0.1 * i);
    Check.near(10, freshness.rate(), 0.5);
    Check.that(!freshness.stale(5) && freshness.stale(8), "two seconds of silence");
  }

  public void numbersAreReadable() {
    Check.equal("3.142", Text.number(Math.PI));
    Check.equal("12346", Text.number(12345.6));
    Check.equal("1.235e-05", Text.number(1.23456e-5));
    Check.equal("-", Text.number(Double.NaN));
    Check.equal("0.5000 N", Text.quantity(0.5, "N"));
    Check.equal("p", Text.label("p", "-"));
  }
}
