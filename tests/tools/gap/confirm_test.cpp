// Whether held-out data take a name back that was given beside a flexible correction, which is never reported.

#include "confirm.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "armcmc/gap/diagnose.hpp"
#include "armcmc/gap/verify.hpp"
#include "tools/gap/gap_rig.hpp"

namespace armcmc::gap::confirm_test {
namespace {

constexpr int kRows = 6000, kFirst = 4200;

/// A bias that was named beside an error of the law, in data that hold nothing but the bias.
class BesideACorrection : public ::testing::Test {
 protected:
  BesideACorrection()
      : equation_(std::move(MakeEquations("hunt_crossley").front())),
        recording_(test::Measure({test::Hidden("force_bias")}, kRows, 0.02, 21).recording),
        diagnosis_(Diagnose(*equation_, recording_.Slice(0, kFirst))) {
    Finding& finding = diagnosis_.finding;
    const Fitter& fitter = *diagnosis_.wide->fitter;
    const EffectForm* law = nullptr;
    for (const EffectForm& form : diagnosis_.wide->catalogue)
      if (form.regular) law = &form;
    auto named = std::make_shared<Candidate>(*finding.best);
    named->probability = 1.0;
    named->correction = std::make_shared<FlexibleCorrection>();
    named->correction->without = fitter.Add(finding.base->fit, {law, {}});
    named->correction->with = fitter.Add(named->fit, {law, {}});
    finding.set = {named};
    finding.tried = {named, finding.best};  // the effect without the correction is a candidate as well
    finding.best = named;
  }

  [[nodiscard]] Candidate& named() { return *diagnosis_.finding.best; }
  [[nodiscard]] Verdict Confirmed() {
    Result result;
    Confirm(*equation_, HeldOut(*equation_, *diagnosis_.wide, recording_, kFirst), {}, &diagnosis_, &result);
    return diagnosis_.finding.verdict;
  }

  std::unique_ptr<Equation> equation_;
  Recording recording_;
  Diagnosis diagnosis_;
};

TEST_F(BesideACorrection, AnEffectThatHoldsIsNamed) {
  ASSERT_EQ(named().names(), std::vector<std::string>{"force_bias"});
  EXPECT_EQ(Confirmed(), Verdict::kNamed);
}

TEST_F(BesideACorrection, ACorrectionThatErrsOnTheRestTakesNoName) {
  named().correction->with.theta.tail(25).array() += 0.25;  // every share
  EXPECT_EQ(Confirmed(), Verdict::kNamed);
}

TEST_F(BesideACorrection, AnEffectThatIsOfNoUseWithoutItIsNotNamed) {
  named().fit.theta[3] = 0.0;
  EXPECT_EQ(Confirmed(), Verdict::kUnnamed);
}

}  // namespace
}  // namespace armcmc::gap::confirm_test
