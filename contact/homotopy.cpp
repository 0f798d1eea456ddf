#include "contact/homotopy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/glocker_law.hpp"

namespace perp::contact {
namespace {

constexpr double most_centring = 0.8;
/// sigma at least after a step below `short_step`; the second-order term is left out where the predictor comes no
/// further than that.
constexpr double safe_centring = 0.5;
constexpr double short_step = 0.1;
constexpr int neighbourhood_cuts = 6;
constexpr double cut = 0.8;
constexpr double least_delta = 1e-13;
constexpr double diagonal_term = 1e-14;
/// Steps below this are none; so many of them end the run.
constexpr double vanishing_step = 1e-7;
constexpr int vanishing_steps = 3;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

Homotopy::Homotopy(const Scaled& problem, const HomotopyOptions& options, std::shared_ptr<lcp::SparseLu> lu)
    : problem_(problem),
      options_(options),
      K_(problem.W),
      lu_(lu != nullptr ? std::move(lu) : std::make_shared<lcp::SparseLu>(options.lu)) {
  of_.resize(problem.blocks.size());
  for (const Scaled::Block& block : problem.blocks) {
    products_ += 1 + multipliers(block.size);
    for (int j = 0; j < block.size; ++j) {
      const Index col = block.first + j;
      const int* begin = K_.innerIndexPtr() + K_.outerIndexPtr()[col];
      const int* end = K_.innerIndexPtr() + K_.outerIndexPtr()[col + 1];
      const auto place = std::lower_bound(begin, end, static_cast<int>(block.first)) - K_.innerIndexPtr();
      for (int i = 0; i < block.size; ++i) {
        block_entries_.push_back(place + i);
        W_diagonal_.push_back(K_.valuePtr()[place + i]);
      }
    }
  }
  r_ = Vec::Zero(problem.size());
  for (const Scaled::Block& block : problem.blocks) r_[block.first] = 1;
  tau_ = 1;
  begin();
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    Multipliers& m = of_[a];
    m.kappa.fill(1);
    m.w_N = std::max(u_[block.first], 1.0);
    for (int i = 0; i < multipliers(block.size); ++i) m.w[at(i)] = std::max(sigma(r_, block, m, i), 1.0);
  }
  tau_ = gap(r_, of_);
}

void Homotopy::start(In r, double tau) {
  r_ = r;
  tau_ = tau;
  begin();
  centre(tau);
}

void Homotopy::begin() {
  last_ = {.k = 0, .tau = tau_};
  last_step_ = 1;
  short_steps_ = 0;
  parameters();
  u_ = problem_.W * r_ + problem_.q;
}

double Homotopy::sigma(const Vec& r, const Scaled::Block& block, const Multipliers& m, int i) const {
  const double N = r[block.first];
  const double T1 = r[block.first + 1];
  const double T2 = block.size == 3 ? r[block.first + 2] : 0;
  if (i < facets(block.size)) {
    const auto& e = facet_normal(block.size, at(i));
    return N - e[0] * T1 - e[1] * T2 + eps_ * m.kappa[at(i)];
  }
  const double g = smooth_normal(N, delta_).g;
  return g - (T1 * T1 + T2 * T2) / g;
}

void Homotopy::parameters() {
  delta_ = std::clamp(options_.delta_share * tau_, least_delta, 1.0);
  eps_ = options_.eps_share * tau_;
}

/// Products about tau at r, w >= F: where one factor is far from zero the other is tau over it, both are sqrt(tau)
/// where neither is. kappa_D begins at |u_T| g / (2 |r_T|), what it is where the contact slips.
void Homotopy::centre(double tau) {
  const double root = std::sqrt(tau);
  const auto pair = [&](double& z, double& w, double F) {
    w = std::max(F, tau / std::max(z, root));
    z = std::max(z, tau / std::max(w, root));
  };
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Index N = block.first;
    Multipliers& m = of_[a];
    pair(r_[N], m.w_N, u_[N]);
    for (int i = 0; i < multipliers(block.size); ++i) {
      m.kappa[at(i)] = 0;
      if (i == facets(block.size)) {
        const double length = r_.segment(N + 1, 2).norm();
        if (length > 0) m.kappa[at(i)] = u_.segment(N + 1, 2).norm() * smooth_normal(r_[N], delta_).g / (2 * length);
      }
      const double sigma_i = sigma(r_, block, m, i);
      pair(m.kappa[at(i)], m.w[at(i)], sigma_i);
    }
  }
  u_ = problem_.W * r_ + problem_.q;
  tau_ = gap(r_, of_);
}

/// The mean product.
double Homotopy::gap(const Vec& r, const std::vector<Multipliers>& of) const {
  double sum = 0;
  for (std::size_t a = 0; a < of.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    sum += r[block.first] * of[a].w_N;
    for (int i = 0; i < multipliers(block.size); ++i) sum += of[a].kappa[at(i)] * of[a].w[at(i)];
  }
  return products_ > 0 ? sum / static_cast<double>(products_) : 0;
}

/// K = W + the diagonal blocks that the eliminated multipliers leave, and its factors.
bool Homotopy::assemble() {
  std::size_t k = 0;
  double* values = K_.valuePtr();
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Multipliers& m = of_[a];
    std::array<std::array<double, 3>, 3> B{};  // B[row][column]
    B[0][0] = m.w_N / r_[block.first];
    if (block.size > 1) {
      const int tangents = block.size - 1;
      for (int f = 0; f < facets(block.size); ++f) {
        const auto& e = facet_normal(block.size, at(f));
        const double D = eps_ + m.w[at(f)] / m.kappa[at(f)];
        for (int i = 0; i < tangents; ++i) {
          B[at(i + 1)][0] -= e[at(i)] / D;
          for (int j = 0; j < tangents; ++j) B[at(i + 1)][at(j + 1)] += e[at(i)] * e[at(j)] / D;
        }
      }
    }
    if (block.size == 3) {
      const SmoothNormal d = smooth_normal(r_[block.first], delta_);
      const double T[2] = {r_[block.first + 1], r_[block.first + 2]};
      const double D = m.w[3] / m.kappa[3];
      const double dN = d.slope * (1 + (T[0] * T[0] + T[1] * T[1]) / (d.g * d.g));
      for (int i = 0; i < 2; ++i) {
        const double b = 2 * T[i] / d.g;
        B[at(i + 1)][0] -= b * dN / D + b * m.kappa[3] * d.slope / d.g;
        for (int j = 0; j < 2; ++j) B[at(i + 1)][at(j + 1)] += b * 2 * T[j] / d.g / D;
        B[at(i + 1)][at(i + 1)] += 2 * m.kappa[3] / d.g;
      }
    }
    for (int j = 0; j < block.size; ++j)
      for (int i = 0; i < block.size; ++i, ++k)
        values[block_entries_[k]] = W_diagonal_[k] + B[at(i)][at(j)] + (i == j ? diagonal_term : 0);
  }
  ++factorizations_;
  return lu_->try_factor(K_);
}

/// Newton's direction towards products `target`, with the second-order terms of `affine` if there is one.
Homotopy::Direction Homotopy::direction(double target, const Direction* affine) const {
  Direction d{.r = Vec(r_.size()), .of = std::vector<Multipliers>(of_.size())};
  Vec rhs(r_.size());
  std::vector<std::array<double, 4>> local(of_.size());  // right-hand sides of the multipliers' rows
  const auto product = [&](double z, double w, double dz, double dw) {
    return (target - z * w - (affine != nullptr ? dz * dw : 0)) / z;
  };
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Multipliers& m = of_[a];
    const Index N = block.first;
    const Multipliers* second = affine != nullptr ? &affine->of[a] : nullptr;
    rhs[N] = -(u_[N] - m.w_N) + product(r_[N], m.w_N, second ? affine->r[N] : 0, second ? second->w_N : 0);
    const int tangents = block.size - 1;
    for (int i = 0; i < tangents; ++i) rhs[N + 1 + i] = -u_[N + 1 + i];
    for (int i = 0; i < multipliers(block.size); ++i)
      local[a][at(i)] =
          -(sigma(r_, block, m, i) - m.w[at(i)]) +
          product(m.kappa[at(i)], m.w[at(i)], second ? second->kappa[at(i)] : 0, second ? second->w[at(i)] : 0);
    for (int f = 0; tangents > 0 && f < facets(block.size); ++f) {
      const double D = eps_ + m.w[at(f)] / m.kappa[at(f)];
      const auto& e = facet_normal(block.size, at(f));
      for (int i = 0; i < tangents; ++i) rhs[N + 1 + i] -= e[at(i)] * (m.kappa[at(f)] + local[a][at(f)] / D);
    }
    if (block.size == 3) {
      const double g = smooth_normal(r_[N], delta_).g;
      const double D = m.w[3] / m.kappa[3];
      for (int i = 0; i < 2; ++i) rhs[N + 1 + i] -= 2 * r_[N + 1 + i] / g * (m.kappa[3] + local[a][3] / D);
    }
  }
  lu_->solve(rhs, d.r);
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    const Multipliers& m = of_[a];
    const Index N = block.first;
    const Multipliers* second = affine != nullptr ? &affine->of[a] : nullptr;
    const auto slack = [&](double z, double w, double dz, double affine_dz, double affine_dw) {
      return product(z, w, affine_dz, affine_dw) - w / z * dz;
    };
    d.of[a].w_N = slack(r_[N], m.w_N, d.r[N], second ? affine->r[N] : 0, second ? second->w_N : 0);
    for (int i = 0; i < multipliers(block.size); ++i) {
      double change = 0;  // of sigma_i by dr
      double D = m.w[at(i)] / m.kappa[at(i)];
      if (i < facets(block.size)) {
        const auto& e = facet_normal(block.size, at(i));
        change = d.r[N] - e[0] * d.r[N + 1] - (block.size == 3 ? e[1] * d.r[N + 2] : 0);
        D += eps_;
      } else {
        const SmoothNormal k = smooth_normal(r_[N], delta_);
        const double T1 = r_[N + 1], T2 = r_[N + 2];
        change =
            k.slope * (1 + (T1 * T1 + T2 * T2) / (k.g * k.g)) * d.r[N] - 2 / k.g * (T1 * d.r[N + 1] + T2 * d.r[N + 2]);
      }
      d.of[a].kappa[at(i)] = (local[a][at(i)] - change) / D;
      d.of[a].w[at(i)] = slack(m.kappa[at(i)], m.w[at(i)], d.of[a].kappa[at(i)], second ? second->kappa[at(i)] : 0,
                               second ? second->w[at(i)] : 0);
    }
  }
  return d;
}

/// The step to the boundary, at most one.
double Homotopy::reach(const Direction& d) const {
  double alpha = 1;
  const auto limit = [&alpha](double value, double change) {
    if (change < 0) alpha = std::min(alpha, -value / change);
  };
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    limit(r_[block.first], d.r[block.first]);
    limit(of_[a].w_N, d.of[a].w_N);
    for (int i = 0; i < multipliers(block.size); ++i) {
      limit(of_[a].kappa[at(i)], d.of[a].kappa[at(i)]);
      limit(of_[a].w[at(i)], d.of[a].w[at(i)]);
    }
  }
  return alpha;
}

/// The mean product after a step.
double Homotopy::mean_after(const Direction& d, double alpha) const {
  double sum = 0;
  for (std::size_t a = 0; a < of_.size(); ++a) {
    const Scaled::Block& block = problem_.blocks[a];
    sum += (r_[block.first] + alpha * d.r[block.first]) * (of_[a].w_N + alpha * d.of[a].w_N);
    for (int i = 0; i < multipliers(block.size); ++i)
      sum += (of_[a].kappa[at(i)] + alpha * d.of[a].kappa[at(i)]) * (of_[a].w[at(i)] + alpha * d.of[a].w[at(i)]);
  }
  return products_ > 0 ? sum / static_cast<double>(products_) : 0;
}

/// alpha x 0.8, at most a few times, until the least product is no less than `neighbourhood` times the mean.
double Homotopy::shortened(const Direction& d, double alpha) const {
  for (int k = 0; k < neighbourhood_cuts; ++k, alpha *= cut) {
    double sum = 0;
    double least = std::numeric_limits<double>::infinity();
    const auto take = [&](double product) {
      sum += product;
      least = std::min(least, product);
    };
    for (std::size_t a = 0; a < of_.size(); ++a) {
      const Scaled::Block& block = problem_.blocks[a];
      take((r_[block.first] + alpha * d.r[block.first]) * (of_[a].w_N + alpha * d.of[a].w_N));
      for (int i = 0; i < multipliers(block.size); ++i)
        take((of_[a].kappa[at(i)] + alpha * d.of[a].kappa[at(i)]) * (of_[a].w[at(i)] + alpha * d.of[a].w[at(i)]));
    }
    if (least >= options_.neighbourhood * sum / static_cast<double>(products_)) break;
  }
  return alpha;
}

bool Homotopy::step() {
  parameters();
  if (products_ == 0 || !assemble()) return false;
  const Direction affine = direction(0, nullptr);
  if (!affine.r.allFinite()) return false;
  const double affine_step = reach(affine);
  const double ratio = std::max(0.0, mean_after(affine, affine_step)) / tau_;
  double least = options_.least_centring;
  if (last_step_ < short_step) least = std::max(least, safe_centring);
  const double sigma = std::clamp(ratio * ratio * ratio, std::min(least, most_centring), most_centring);
  const Direction d = direction(sigma * tau_, affine_step > short_step ? &affine : nullptr);
  if (!d.r.allFinite()) return false;
  const double alpha = shortened(d, std::min(1.0, options_.to_boundary * reach(d)));
  r_ += alpha * d.r;
  for (std::size_t a = 0; a < of_.size(); ++a) {
    of_[a].w_N += alpha * d.of[a].w_N;
    for (std::size_t i = 0; i < 4; ++i) {
      of_[a].kappa[i] += alpha * d.of[a].kappa[i];
      of_[a].w[i] += alpha * d.of[a].w[i];
    }
  }
  u_ = problem_.W * r_ + problem_.q;
  tau_ = gap(r_, of_);
  last_step_ = alpha;
  last_ = {.k = last_.k + 1, .tau = tau_, .step = alpha, .sigma = sigma};
  short_steps_ = alpha < vanishing_step ? short_steps_ + 1 : 0;
  return std::isfinite(tau_) && tau_ > 0 && short_steps_ < vanishing_steps;
}

}  // namespace perp::contact
