// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The numbers of pies (see pies.cpp): an energy market after Hogan 1975 and Josephy 1979, with two regions r that
/// produce coal and crude oil at three and two costs t, two refineries f and two regions u of users. Fuels g: coal (C),
/// light oil (L), heavy oil (H); resources s: capital, steel. Private to the collection.

namespace perp::ncp::collection::pies_tables {

constexpr int regions = 2, coals = 3, oils = 2, refineries = 2, users = 2, fuels = 3, resources = 2;

constexpr double rmax[resources] = {35000, 12000};
/// Capacities, by region and cost.
constexpr double cmax[regions][coals] = {{300, 300, 400}, {200, 300, 600}};
constexpr double omax[regions][oils] = {{1100, 1200}, {1300, 1100}};
constexpr double ccost[regions][coals] = {{5, 6, 8}, {4, 5, 7}};
constexpr double ocost[regions][oils] = {{1, 1.5}, {1.25, 1.5}};
/// Resources a unit takes, by resource, region and cost.
constexpr double cruse[resources][regions][coals] = {{{1, 5, 10}, {1, 5, 6}}, {{1, 2, 3}, {1, 4, 5}}};
constexpr double oruse[resources][regions][oils] = {{{0, 10}, {0, 15}}, {{0, 4}, {0, 2}}};
/// Refining: its cost, and what a unit of crude gives of light and heavy oil.
constexpr double rcost[refineries] = {6.5, 5};
constexpr double output[refineries][2] = {{0.6, 0.4}, {0.5, 0.5}};
/// Transport of coal (region, user), crude (region, refinery), light and heavy oil (refinery, user).
constexpr double ctcost[regions][users] = {{1, 2.5}, {0.75, 2.75}};
constexpr double otcost[regions][refineries] = {{2, 3}, {4, 2}};
constexpr double ltcost[refineries][users] = {{1, 1.2}, {1, 1.5}};
constexpr double htcost[refineries][users] = {{1, 1.2}, {1, 1.5}};
/// Demand q0_g prod_h (p_h / p0_h)^esub_gh.
constexpr double q0[fuels] = {1000, 1200, 1000};
constexpr double p0[fuels] = {12, 16, 12};
constexpr double esub[fuels][fuels] = {{-0.75, 0.1, 0.2}, {0.1, -0.5, 0.2}, {0.2, 0.1, -0.5}};

/// The start; the multipliers start at 1.
constexpr double i_c[regions][coals] = {{300, 300, 400}, {200, 300, 600}};
constexpr double i_o[regions][oils] = {{1100, 1000}, {1300, 1000}};
constexpr double i_ct[regions][users] = {{0, 828}, {1016, 84}};
constexpr double i_ot[regions][refineries] = {{2075, 0}, {0, 2358}};
constexpr double i_lt[refineries][users] = {{22, 1223}, {1179, 0}};
constexpr double i_ht[refineries][users] = {{0, 830}, {998, 180}};
constexpr double iprice[fuels][users] = {{11.7, 13.7}, {15.8, 16.0}, {11.9, 12.4}};

}  // namespace perp::ncp::collection::pies_tables
