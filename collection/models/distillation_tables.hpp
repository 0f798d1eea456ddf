// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Fletcher's distillation columns as printed in More 1990 (see distillation.cpp); the solutions are recomputed to full
/// precision. Private to the collection.

namespace perp::ncp::collection::distillation_tables {

struct Column {
  static constexpr int max_stages = 8, max_components = 3;
  const char* name;
  int n, m;        ///< stages, components
  int feed_stage;  ///< counted from 0: the liquid feed enters there, the vapour feed one stage higher
  double a[max_components], b[max_components], c[max_components];       ///< Antoine's equation
  double al[max_components], al1[max_components], al2[max_components];  ///< enthalpy of the liquid
  double be[max_components], be1[max_components], be2[max_components];  ///< enthalpy of the vapour
  double feed_liquid[max_components], feed_vapour[max_components];
  double feed_temperature, bottoms, distillate, heat;
  double pressure[max_stages];
};

constexpr Column hydroc06{.name = "hydroc06",
                          .n = 6,
                          .m = 3,
                          .feed_stage = 2,
                          .a = {9.647, 9.953, 9.466},
                          .b = {-2998, -3448.1, -3347.25},
                          .c = {230.66, 235.88, 215.31},
                          .al = {0, 0, 0},
                          .al1 = {37.6, 48.2, 45.4},
                          .al2 = {0, 0, 0},
                          .be = {8425, 9395, 10466},
                          .be1 = {24.2, 35.6, 31.9},
                          .be2 = {0, 0, 0},
                          .feed_liquid = {30, 30, 40},
                          .feed_vapour = {0, 0, 0},
                          .feed_temperature = 100,
                          .bottoms = 40,
                          .distillate = 60,
                          .heat = 2500000,
                          .pressure = {1, 1, 1, 1, 1, 1}};
constexpr double hydroc06_start[29] = {0,   0.2, 0.9, 0,   0.2, 0.8, 0.05, 0.3, 0.8, 0.1, 0.3, 0.6, 0.3, 0.5, 0.3,
                                       0.6, 0.6, 0,   100, 100, 100, 100,  100, 100, 300, 300, 300, 300, 300};
constexpr double hydroc06_solution[29] = {
    0.005472248552475392, 0.12953722332897052, 0.8649905281185551,  0.02007671836697655, 0.22255560164324673,
    0.7573676799897768,   0.06451430119296975, 0.3302534329475756,  0.6052322658594548,  0.11720095026150983,
    0.44283268316358215,  0.439966366574908,   0.24944700150596688, 0.501567512749221,   0.2489854857448121,
    0.49635183429834967,  0.4136418511140197,  0.09000631458763068, 132.68254595819107,  127.94227948857382,
    120.5693460063513,    113.64973605160908,  103.97700173153345,  93.190167360106,     288.90172190757403,
    288.5577979797477,    288.66902025323816,  293.33851055952715,  303.0208430688248};

constexpr Column methan08{.name = "methan08",
                          .n = 8,
                          .m = 2,
                          .feed_stage = 2,
                          .a = {18.5751, 18.3443},
                          .b = {-3632.649, -3841.2203},
                          .c = {239.2, 228},
                          .al = {0, 0},
                          .al1 = {15.97, 18.1},
                          .al2 = {0.0422, 0},
                          .be = {9566.67, 10834.67},
                          .be1 = {-1.59, 8.74},
                          .be2 = {0.0422, 0},
                          .feed_liquid = {451.25, 684.25},
                          .feed_vapour = {0, 0},
                          .feed_temperature = 89,
                          .bottoms = 693.37,
                          .distillate = 442.13,
                          .heat = 8386200,
                          .pressure = {1210, 1200, 1190, 1180, 1170, 1160, 1150, 1140}};
constexpr double methan08_start[31] = {0.09203, 0.908,  0.1819, 0.8181, 0.284,  0.716,  0.3051, 0.6949,
                                       0.3566,  0.6434, 0.468,  0.532,  0.6579, 0.3421, 0.8763, 0.1237,
                                       120,     110,    100,    88,     86,     84,     80,     76,
                                       886.37,  910.01, 922.52, 926.45, 935.56, 952.83, 975.73};
constexpr double methan08_solution[31] = {
    0.09225723236421947, 0.9077427676357812,  0.1821995285312065, 0.8178004714687939,  0.28421889854366605,
    0.7157811014563339,  0.30530731675985706, 0.6946926832401433, 0.3566490103973168,  0.6433509896026834,
    0.467791111028162,   0.5322088889718378,  0.6573895966863109, 0.34261040331368914, 0.8759450903481355,
    0.1240549096518645,  107.76537957980626,  102.68498908598436, 97.71772476055266,   96.57726115013135,
    94.26309926727774,   89.98899748591789,   83.97342066984531,  78.32157508655415,   886.7137742582911,
    910.3656929177114,   922.1591291059577,   926.0766775727477,  935.1735260591248,   952.4236258294616,
    975.0192103423748};

}  // namespace perp::ncp::collection::distillation_tables
