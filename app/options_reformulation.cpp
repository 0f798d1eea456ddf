#include <array>

#include "app/options_parts.hpp"
#include "ncp/cfunction.hpp"
#include "ncp/smoothing_function.hpp"

namespace perp::app {

namespace {

/// The catalogue's names; the value is the place in it.
template <class Functions>
std::vector<Choice> choices_of(const Functions& functions) {
  std::vector<Choice> choices;
  for (std::size_t k = 0; k < functions.size(); ++k) choices.push_back({functions[k].name, static_cast<int>(k)});
  return choices;
}

template <class Functions>
int place_of(const Functions& functions, std::string_view name) {
  for (std::size_t k = 0; k < functions.size(); ++k)
    if (functions[k].name == name) return static_cast<int>(k);
  return -1;
}

std::span<const Choice> cfunction_choices() {
  static const std::vector<Choice> choices = choices_of(ncp::cfunctions());
  return choices;
}

std::span<const Choice> smoothing_choices() {
  static const std::vector<Choice> choices = choices_of(ncp::smoothing_functions());
  return choices;
}

constexpr std::array schedule_choices{
    Choice{"newton-armijo", static_cast<int>(ncp::SmoothingSchedule::NewtonArmijo)},
    Choice{"predictor-corrector", static_cast<int>(ncp::SmoothingSchedule::PredictorCorrector)}};

}  // namespace

std::vector<Option> reformulation_options() {
  return {
      Option{"cfunction",
             {},
             {},
             "the C-function of the reformulation; 'perp cfunctions' explains them",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::SemismoothNewton>(&settings.method);
               if (method == nullptr) return {};
               return Word{
                   cfunction_choices(), [method] { return place_of(ncp::cfunctions(), method->cfunction.name); },
                   [method](int place) { method->cfunction = ncp::cfunctions()[static_cast<std::size_t>(place)]; }};
             }},
      Option{"cfunction_parameter",
             {},
             {},
             "its parameter: lambda, rho or alpha",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::SemismoothNewton>(&settings.method);
               if (method == nullptr) return {};
               return DependentNumber{
                   [method] {
                     const auto& parameter = method->cfunction.parameter;
                     return parameter ? std::optional(parameter->value) : std::nullopt;
                   },
                   [method](double value) { method->cfunction = ncp::cfunction(method->cfunction.name, value); },
                   "a number in the function's range"};
             }},
      Option{"smoothing_function",
             {},
             {},
             "the smooth approximation of the reformulation; 'perp cfunctions' explains them",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::Smoothing>(&settings.method);
               if (method == nullptr) return {};
               return Word{smoothing_choices(),
                           [method] { return place_of(ncp::smoothing_functions(), method->function.name); },
                           [method](int place) {
                             method->function = ncp::smoothing_functions()[static_cast<std::size_t>(place)];
                           }};
             }},
      Option{"smoothing_schedule",
             {},
             {},
             "how its parameter mu shrinks: newton-armijo (with the residual) or predictor-corrector (along the path "
             "Phi_mu(x) = 0)",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::Smoothing>(&settings.method);
               if (method == nullptr) return {};
               return word(method->schedule, schedule_choices);
             }},
      Option{"smoothing_finish",
             {},
             {},
             "Newton steps on the active set at the end",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::Smoothing>(&settings.method);
               if (method == nullptr) return {};
               return &method->finish;
             }},
      Option{"interior_centring",
             {},
             {0, 1, true},
             "interior: sigma at least, the share of the mean product tau that a step aims at",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::InteriorPoint>(&settings.method);
               if (method == nullptr) return {};
               return &method->least_centring;
             }},
      Option{"interior_to_boundary",
             {},
             {0, 1, true},
             "interior: share of the way to the boundary that a step goes at most",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::InteriorPoint>(&settings.method);
               if (method == nullptr) return {};
               return &method->to_boundary;
             }},
      Option{"interior_finish",
             {},
             {},
             "interior: Newton steps on the active set at the end",
             [](Settings& settings) -> Field {
               auto* method = std::get_if<ncp::InteriorPoint>(&settings.method);
               if (method == nullptr) return {};
               return &method->finish;
             }},
  };
}

}  // namespace perp::app
