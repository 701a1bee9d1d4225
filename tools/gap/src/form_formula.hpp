#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "armcmc/gap/effect_form.hpp"
#include "armcmc/plant/effect.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "form_program.hpp"

namespace armcmc::gap {

/// The formula of one [[form]] as a graph.
class FormFormula {
 public:
  /// @param coordinates  In this order, amplitudes first.
  FormFormula(support::StrictTable* table, const std::vector<Coordinate>& coordinates, const Signals& signals,
              const std::map<std::string, double>& constants);

  /// @param num_amplitudes  In which it must be linear: its derivatives.
  [[nodiscard]] std::vector<std::shared_ptr<const FormProgram>> Columns(int num_amplitudes);
  /// The formula as it is.
  [[nodiscard]] std::shared_ptr<const FormProgram> Whole() { return Program<FormProgram>(formula_); }
  /// The same in a simulated motion.
  [[nodiscard]] std::shared_ptr<const ForceProgram> Force() { return Program<ForceProgram>(formula_); }
  /// The input `name` less the formula, and the formula less it.
  void TakeFrom(const std::string& name);
  void TakeOff(const std::string& name);

 private:
  int Lower(const std::string& key, const std::string& text, const expression::Scope& scope);
  void ReadOwn();
  void Adopt(const armcmc::EffectForm& form);
  template <class Kind>
  std::shared_ptr<const Kind> Program(int node);

  support::StrictTable* table_;
  expression::Graph graph_;
  expression::Scope scope_;
  std::vector<int> lets_;
  std::vector<FormState> states_;
  int formula_ = -1;
};

/// The form of the catalogue of effects that "effect/variant" means; `slot` as in EffectTerm.
/// @throws support::ConfigError.
[[nodiscard]] const armcmc::EffectForm& CatalogueForm(const support::StrictTable& table, const std::string& takes,
                                                      const std::string& slot);

}  // namespace armcmc::gap
