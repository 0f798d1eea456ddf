// SPDX-License-Identifier: Apache-2.0
#include "contact/scenes/ball.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "lcp/words.hpp"

namespace perp::contact {
namespace {

void check(const char* option, double value, bool valid, const char* range) {
  if (valid && std::isfinite(value)) return;
  refuse_input("ball: ", option, " is ", value, "; it must be ", range);
}

constexpr double most_steps = 1e7;

void check(const CyclicBall& ball) {
  check("mass", ball.mass, ball.mass > 0, "positive");
  check("radius", ball.radius, ball.radius > 0, "positive");
  check("mu", ball.mu, ball.mu >= 0, "at least 0");
  check("gravity", ball.gravity, ball.gravity > 0, "positive");
  check("load", ball.load, ball.load >= 0, "at least 0");
  check("phase", ball.phase, ball.phase > 0, "positive");
  check("cycles", ball.cycles, ball.cycles > 0, "positive");
  check("h", ball.h, ball.h > 0 && ball.h <= ball.phase, "positive, and at most the phase");
  const double steps = 3 * ball.phase * ball.cycles / ball.h;
  check("the number of steps", steps, steps <= most_steps, "at most 1e7");
}

}  // namespace

Vec3 load_direction(const CyclicBall& ball, double t) {
  const double c = 0.5;
  const double s = std::numbers::sqrt3 / 2;
  const auto j = static_cast<int>(std::fmod(t, 3 * ball.phase) / ball.phase);
  return j == 0 ? Vec3(c, s, 0) : j == 1 ? Vec3(-1, 0, 0) : Vec3(c, -s, 0);
}

BallPath run_ball(const CyclicBall& ball, const FrictionLaw& law, const std::function<bool()>& stop) {
  check(ball);
  const auto begin = std::chrono::steady_clock::now();
  MovingBody body = MovingBody::ball(ball.mass, ball.radius);
  body.centre = Vec3(0, 0, ball.radius);
  body.velocity = ball.velocity;
  body.turns = ball.rolls;
  const double force = ball.load * ball.mu * ball.mass * ball.gravity;
  MoreauJean stepping(
      {body}, {{.mu = ball.mu, .frame = ball.frame}},
      {.h = ball.h,
       .theta = ball.theta,
       .gravity = Vec3(0, 0, -ball.gravity),
       .law = law,
       .tol = ball.tol,
       .load = [&ball, force](std::size_t, double t) { return Vec3(force * load_direction(ball, t)); }});

  BallPath path{.law = law, .start_energy = stepping.kinetic() + stepping.potential()};
  const auto record = [&] {
    path.times.push_back(stepping.time());
    path.centres.push_back(stepping.bodies()[0].centre);
    path.velocities.push_back(stepping.bodies()[0].velocity);
  };
  record();
  const auto steps = std::lround(3 * ball.phase * ball.cycles / ball.h);
  for (long k = 0; k < steps; ++k) {
    const Step step = stepping.step();
    if (!step.solved || (stop && stop())) {
      path.solved = false;
      path.message = step.solved ? "interrupted" : step.message;
      break;
    }
    record();
    path.iterations += step.iterations;
    path.worst = std::max(path.worst, step.residual.scaled);
    path.energy.kinetic = step.energy.kinetic;
    path.energy.potential = step.energy.potential;
    path.energy.work += step.energy.work;
    path.energy.friction += step.energy.friction;
    path.energy.impacts += step.energy.impacts;
    path.energy.scheme += step.energy.scheme;
  }
  path.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return path;
}

Vec3 BallPath::drift(const CyclicBall& ball) const {
  const double cycle = std::min(3 * ball.phase, times.back());
  const auto back = std::min(times.size() - 1, static_cast<std::size_t>(std::lround(cycle / ball.h)));
  if (back == 0) return Vec3::Zero();
  const std::size_t end = times.size() - 1;
  return (centres[end] - centres[end - back]) / (times[end] - times[end - back]);
}

}  // namespace perp::contact
