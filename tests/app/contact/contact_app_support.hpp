// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Contact problems with solutions by hand, as Siconos' text files, and what is read of answers and pictures.
///
/// W = I, so that contacts do not act on each other and, with q = (-1, s) at each, r_N = 1 and r_T is the projection of
/// -s on the friction disk of radius mu.
#include <string>

#include "app/contact/contact.hpp"
#include "app/json.hpp"
#include "app/support.hpp"

namespace perp::app::test {

/// n contacts in d dimensions with these q and mu.
inline std::string identity_dat(int d, int n, const std::string& q, const std::string& mu) {
  std::ostringstream text;
  text << d << "\n" << n << "\n0 " << d * n << ' ' << d * n << "\n" << d * n << ' ' << d * n << "\n";
  for (int j = 0; j < d * n; ++j)
    for (int i = 0; i < d * n; ++i) text << (i == j) << (i + 1 < d * n ? ' ' : '\n');
  text << q << "\n" << mu << "\n";
  return text.str();
}

/// Open (q_N = 1); sticking with r = (1, -0.3, 0); slipping with r = (1, -0.3, -0.4), u_T = (0.9, 1.2).
inline std::string three_contacts() { return identity_dat(3, 3, "1 0 0  -1 0.3 0  -1 1.2 1.6", "0.5 0.5 0.5"); }

/// In the plane: slipping with r = (1, -0.5), u_T = 1.5; sticking with r = (1, 0.2).
inline std::string two_plane_contacts() { return identity_dat(2, 2, "-1 2  -1 -0.2", "0.5 0.5"); }

/// What `perp contact` says of a request: the exit code, its JSON and the messages.
struct Answer {
  int code;
  Json result;
  std::string err;
};
inline Answer answer(contacts::ContactRequest request) {
  Captured captured;
  request.json = "-";
  const int code = solve_contact(request, captured.streams);
  return {code, parse_json(captured.out.str()), captured.err.str()};
}

}  // namespace perp::app::test
