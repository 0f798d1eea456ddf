#include <array>
#include <limits>

#include "app/options_parts.hpp"
#include "ncp/cfunction.hpp"
#include "ncp/smoothing_function.hpp"

namespace perp::app {

namespace {

constexpr double max_int = std::numeric_limits<int>::max();

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

constexpr std::array gsl_choices{Choice{"hybridsj", static_cast<int>(ncp::MultirootSolver::Hybridsj)},
                                 Choice{"hybridj", static_cast<int>(ncp::MultirootSolver::Hybridj)},
                                 Choice{"newton", static_cast<int>(ncp::MultirootSolver::Newton)},
                                 Choice{"gnewton", static_cast<int>(ncp::MultirootSolver::Gnewton)}};
constexpr std::array schedule_choices{
    Choice{"newton-armijo", static_cast<int>(ncp::SmoothingSchedule::NewtonArmijo)},
    Choice{"predictor-corrector", static_cast<int>(ncp::SmoothingSchedule::PredictorCorrector)}};

/// The field, if the method is an M.
template <class M, class T>
Field field_of(Settings& settings, T M::*member) {
  if (auto* method = std::get_if<M>(&settings.method)) return &(method->*member);
  return {};
}

/// The field of smooth, with the schedule that reads it.
Field scheduled(Settings& settings, ncp::SmoothingSchedule schedule, double ncp::Smoothing::*member) {
  if (auto* method = std::get_if<ncp::Smoothing>(&settings.method); method != nullptr && method->schedule != schedule)
    return NoEffect{schedule == ncp::SmoothingSchedule::NewtonArmijo ? "smoothing_schedule = predictor-corrector"
                                                                     : "smoothing_schedule = newton-armijo"};
  return field_of(settings, member);
}

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
             [](Settings& settings) { return field_of(settings, &ncp::Smoothing::finish); }},
      Option{"smoothing_shrink",
             {},
             {0, 1, true},
             "newton-armijo: mu x smoothing_shrink where the smooth system is solved",
             [](Settings& settings) {
               return scheduled(settings, ncp::SmoothingSchedule::NewtonArmijo, &ncp::Smoothing::shrink);
             }},
      Option{"smoothing_centring",
             {},
             {0, 1e100, true},
             "newton-armijo: it is solved to smoothing_centring mu",
             [](Settings& settings) {
               return scheduled(settings, ncp::SmoothingSchedule::NewtonArmijo, &ncp::Smoothing::centring);
             }},
      Option{"smoothing_neighbourhood",
             {},
             {0, 1e100, true},
             "predictor-corrector: |Phi_mu| is kept below smoothing_neighbourhood mu; above kappa of the smoothing",
             [](Settings& settings) {
               return scheduled(settings, ncp::SmoothingSchedule::PredictorCorrector, &ncp::Smoothing::neighbourhood);
             }},
      Option{"smoothing_restarts",
             {},
             {0, max_int},
             "times that mu is raised where the residual has stopped falling",
             [](Settings& settings) { return field_of(settings, &ncp::Smoothing::restarts); }},
      Option{"interior_centring",
             {},
             {0, 1, true},
             "interior: sigma at least, the share of the mean product tau that a step aims at",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::least_centring); }},
      Option{"interior_to_boundary",
             {},
             {0, 1, true},
             "interior: share of the way to the boundary that a step goes at most",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::to_boundary); }},
      Option{"interior_finish",
             {},
             {},
             "interior: Newton steps on the active set at the end",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::finish); }},
      Option{"interior_neighbourhood",
             {},
             {0, 1, true},
             "interior: the least product is kept above this share of the mean",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::neighbourhood); }},
      Option{"interior_growth",
             {},
             {1, 1e100, true},
             "interior: factor by which |F - w + v| may grow in one step",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::growth); }},
      Option{"interior_margin",
             {},
             {0, 1e100, true},
             "interior: the start is moved so far inside finite bounds, or to the middle",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::margin); }},
      Option{"interior_restarts",
             {},
             {0, max_int},
             "interior: times that tau is raised where the residual has stopped falling",
             [](Settings& settings) { return field_of(settings, &ncp::InteriorPoint::restarts); }},
      Option{
          "gsl_solver",
          {},
          {},
          "gsl: hybridsj (Powell's hybrid method, scaled), hybridj (unscaled), newton (undamped) or gnewton (damped)",
          [](Settings& settings) -> Field {
            auto* method = std::get_if<ncp::Multiroot>(&settings.method);
            if (method == nullptr) return {};
            return word(method->solver, gsl_choices);
          }},
      Option{"gsl_mu",
             {},
             {0, 1e100, true},
             "gsl: first mu of the smoothed equations",
             [](Settings& settings) { return field_of(settings, &ncp::Multiroot::mu); }},
      Option{"gsl_shrink",
             {},
             {0, 1, true},
             "gsl: factor of mu from stage to stage",
             [](Settings& settings) { return field_of(settings, &ncp::Multiroot::shrink); }},
      Option{"gsl_mu_end",
             {},
             {0, 1e100, true},
             "gsl: last mu; at most gsl_mu",
             [](Settings& settings) { return field_of(settings, &ncp::Multiroot::mu_end); }},
      Option{"gsl_max_size",
             {},
             {0, max_int},
             "gsl: problems of more variables are refused",
             [](Settings& settings) { return field_of(settings, &ncp::Multiroot::max_size); }},
  };
}

}  // namespace perp::app
