// SPDX-License-Identifier: Apache-2.0
/* Contact problems through capi/perp.h: would catch blocks in another order, M and H mixed up, options that do not
   arrive, a judge that is not contact's. The first problem's solution is by hand. */
#include <stdlib.h>

#include "check.h"
#include "helpers.h"

static perp_error error;

/* A mass of 2 kg falls with 1 m/s and slides with 0.1 m/s, mu = 0.5, W = I / 2: r_N = 2 stops it, and friction up to
   1 N s stops the slide, for which 0.2 are enough: stick. */
static const double q[] = {-1, 0.1, 0};
static const double mu[] = {0.5};

static void check_mass(perp_contact* contact) {
  perp_result* result = NULL;
  perp_result* judged = NULL;
  const double nothing[] = {0, 0, 0};
  CHECK(perp_contact_dimension(contact) == 3 && perp_contact_contacts(contact) == 1);
  CHECK_NEAR(perp_contact_q(contact)[0], -1, 1e-15);
  CHECK(perp_contact_mu(contact)[0] == 0.5);
  OK(perp_contact_solve(NULL, contact, NULL, NULL, &result, &error));
  CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
  CHECK(perp_result_status(result) == PERP_SOLVED && perp_result_length(result, "r") == 3);
  CHECK_NEAR(perp_result_reals(result, "r")[0], 2, 1e-6);
  CHECK_NEAR(perp_result_reals(result, "r")[1], -0.2, 1e-6);
  CHECK_NEAR(perp_result_reals(result, "u")[0], 0, 1e-6);
  CHECK(perp_result_cells(result, "states")[0] == PERP_STICK);
  CHECK(perp_result_text(result, "solved_by", 0)[0] != '\0');
  CHECK(number(result, "residual", "siconos") <= 1e-8);
  CHECK(number(result, "stats", "iterations") >= 0 && isnan(number(result, "stats", "no such")));
  OK(perp_contact_judge(contact, perp_result_reals(result, "r"), 1e-8, &judged, &error));
  CHECK(perp_result_integer(judged, "accepted") == 1);
  perp_result_free(judged);
  OK(perp_contact_judge(contact, nothing, 1e-8, &judged, &error));
  CHECK(perp_result_integer(judged, "accepted") == 0 && perp_result_real(judged, "largest") > 0.1);
  perp_result_free(judged);
  /* From these impulses there is nothing left to do. */
  OK(perp_contact_solve(NULL, contact, NULL, perp_result_reals(result, "r"), &judged, &error));
  CHECK(solved(judged) && strcmp(perp_result_text(judged, "solved_by", 0), "warm-start") == 0);
  perp_result_free(judged);
  perp_result_free(result);
}

static void given_as_W(void) {
  const int32_t start[] = {0, 1, 2, 3};
  const int32_t row[] = {0, 1, 2};
  const double value[] = {0.5, 0.5, 0.5};
  const double bad_mu[] = {-1};
  const perp_matrix W = csc32(3, start, row, value), no_rows = csc32(3, start, NULL, value);
  perp_matrix again;
  perp_contact* contact = NULL;
  OK(perp_contact_create(PERP_INTERFACE, 3, 1, &W, q, mu, &contact, &error));
  check_mass(contact);
  OK(perp_contact_W(contact, &again, &error));
  CHECK(again.rows == 3 && again.columns == 3 && again.value[2] == 0.5 && ((const int32_t*)again.index)[2] == 2);
  perp_contact_free(contact);
  REFUSED(perp_contact_create(PERP_INTERFACE, 4, 1, &W, q, mu, &contact, &error), PERP_BAD_ARGUMENT, "dimension: 4");
  REFUSED(perp_contact_create(PERP_INTERFACE, 3, 1, &W, q, bad_mu, &contact, &error), PERP_BAD_ARGUMENT,
          "mu: entry [0] is -1");
  REFUSED(perp_contact_create(PERP_INTERFACE, 3, 1, &no_rows, q, mu, &contact, &error), PERP_BAD_ARGUMENT,
          "W: index is NULL");
  REFUSED(perp_contact_create(PERP_INTERFACE, 3, 1, &W, q, NULL, &contact, &error), PERP_BAD_ARGUMENT, "mu: is NULL");
  CHECK(contact == NULL);
}

/* Moments 4 / 5 kg m^2 besides, and q_R = (3, -4), of which mu_r r_N = 0.6 stops a part: it rolls on. */
static void rolls(void) {
  const int32_t start[] = {0, 1, 2, 3, 4, 5};
  const int32_t row[] = {0, 1, 2, 3, 4};
  const double value[] = {0.5, 0.5, 0.5, 1.25, 1.25};
  const double rolling_q[] = {-3, 0.6, -0.8, 3, -4};
  const double mu_r[] = {0.1};
  const perp_matrix W = csc32(5, start, row, value);
  perp_contact* contact = NULL;
  perp_result* result = NULL;
  OK(perp_contact_create_rolling(PERP_INTERFACE, 5, 1, &W, rolling_q, mu, mu_r, &contact, &error));
  CHECK(perp_contact_dimension(contact) == 5 && perp_contact_mu_r(contact)[0] == 0.1);
  OK(perp_contact_solve(NULL, contact, NULL, NULL, &result, &error));
  CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
  CHECK_NEAR(perp_result_reals(result, "r")[3], -0.36, 1e-6);
  CHECK(perp_result_cells(result, "states")[0] == PERP_ROLL);
  perp_result_free(result);
  perp_contact_free(contact);
  REFUSED(perp_contact_create_rolling(PERP_INTERFACE, 2, 1, &W, rolling_q, mu, mu_r, &contact, &error),
          PERP_BAD_ARGUMENT, "dimension: 2 is neither 3 nor 5");
  REFUSED(perp_contact_create_rolling(PERP_INTERFACE, 5, 1, &W, rolling_q, mu, NULL, &contact, &error),
          PERP_BAD_ARGUMENT, "mu_r: is NULL");
  CHECK(contact == NULL);
}

/* M = 2 I, H = I: W = I / 2; f = 0, w = q. */
static void given_as_bodies(void) {
  const int64_t start[] = {0, 1, 2, 3};
  const int64_t row[] = {0, 1, 2};
  const double M[] = {2, 2, 2};
  const double singular[] = {2, 0, 2};
  const double ones[] = {1, 1, 1};
  const double f[] = {0, 0, 0};
  const perp_matrix inertia = csc64(3, start, row, M), none = csc64(3, start, row, singular);
  const perp_matrix H = csc64(3, start, row, ones);
  perp_contact* contact = NULL;
  OK(perp_contact_condense(PERP_INTERFACE, 3, 1, &inertia, &H, f, q, mu, &contact, &error));
  check_mass(contact);
  perp_contact_free(contact);
  REFUSED(perp_contact_condense(PERP_INTERFACE, 3, 1, &none, &H, f, q, mu, &contact, &error), PERP_BAD_ARGUMENT, "M");
  CHECK(contact == NULL);
}

static void from_a_file(void) {
  static const char* const variants[] = {NULL,           "glocker",       "glocker+homotopy",
                                         "glocker+path", "inner:8+lemke", "frictionless"};
  size_t v;
  perp_contact* contact = NULL;
  perp_result* result = NULL;
  perp_solver* solver = NULL;
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_contact_read(PERP_INTERFACE, PERP_SOURCE_DIR "/data/contact/arch-9.hdf5", &contact, &error));
  for (v = 0; v < sizeof variants / sizeof *variants; ++v) {
    OK(perp_contact_solve(solver, contact, variants[v], NULL, &result, &error));
    CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
    perp_result_free(result);
  }
  REFUSED(perp_contact_solve(solver, contact, "glocker+nonsense", NULL, &result, &error), PERP_BAD_ARGUMENT,
          "variant: ");
  /* A limit that is reached: without time nothing is solved. */
  OK(perp_solver_set(solver, "convergence_tolerance", "1e-11", &error));
  OK(perp_solver_set(solver, "time_limit", "1e-9", &error));
  OK(perp_contact_solve(solver, contact, "glocker+homotopy", NULL, &result, &error));
  CHECK_SAYING(perp_result_status(result) == PERP_TIME_LIMIT, perp_result_text(result, "message", 0));
  perp_result_free(result);
  OK(perp_solver_clear_options(solver, &error));
  perp_solver_interrupt(solver);
  OK(perp_contact_solve(solver, contact, "glocker+homotopy", NULL, &result, &error));
  CHECK_SAYING(perp_result_status(result) == PERP_INTERRUPTED, perp_result_text(result, "message", 0));
  perp_result_free(result);
  /* Options of the methods, and one that the method has not. */
  OK(perp_solver_set(solver, "psor_omega", "1.5", &error));
  REFUSED(perp_contact_solve(solver, contact, "glocker+homotopy", NULL, &result, &error), PERP_BAD_OPTION,
          "psor_omega");
  perp_solver_free(solver);
  perp_contact_free(contact);
  REFUSED(perp_contact_read(PERP_INTERFACE, "/no/such.hdf5", &contact, &error), PERP_BAD_FILE, "/no/such.hdf5");
}

/* A made arch stands: it has a solution, and without friction it falls, which is proven. */
static void scenes(void) {
  perp_contact* contact = NULL;
  perp_result *result = NULL, *list = NULL;
  int64_t k;
  int known = 0;
  OK(perp_contact_scene(PERP_INTERFACE, "arch", 40, 1, &contact, &error));
  CHECK(perp_contact_contacts(contact) >= 30 && perp_contact_contacts(contact) <= 50);
  CHECK(perp_contact_name(contact)[0] != '\0');
  OK(perp_contact_solve(NULL, contact, NULL, NULL, &result, &error));
  CHECK_SAYING(solved(result), perp_result_text(result, "message", 0));
  perp_result_free(result);
  OK(perp_contact_existence(NULL, contact, &result, &error));
  CHECK_SAYING(strcmp(perp_result_text(result, "existence", 0), "none") != 0, perp_result_text(result, "message", 0));
  perp_result_free(result);
  perp_contact_free(contact);
  REFUSED(perp_contact_scene(PERP_INTERFACE, "arches", 40, 1, &contact, &error), PERP_BAD_ARGUMENT, "'arch'");
  REFUSED(perp_contact_scene(PERP_INTERFACE, "arch", 0, 1, &contact, &error), PERP_BAD_ARGUMENT, "contacts: 0");
  OK(perp_list(PERP_INTERFACE, "scenes", &list, &error));
  for (k = 0; k < perp_result_length(list, "items"); ++k)
    if (strcmp(perp_result_text(perp_result_part(list, "items", k), "name", 0), "wall") == 0) ++known;
  CHECK(known == 1);
  perp_result_free(list);
}

/* The block of check_mass slips under a push of 0.9: r_T = -mu r_N, so by q_N dr = (-2, 1, 0), by mu (0, -2, 0). Would
   catch columns in another order, and a kink that is called differentiable. */
static void derivatives(void) {
  const int32_t start[] = {0, 1, 2, 3};
  const int32_t row[] = {0, 1, 2};
  const double value[] = {0.5, 0.5, 0.5};
  const double pushed[] = {-1, 0.9, 0}, r[] = {2, -1, 0}, at_the_edge[] = {-1, 0.5, 0};
  const double dq_of_push[] = {0, 1, 0}, up[] = {1};
  const perp_matrix W = csc32(3, start, row, value);
  perp_matrix dq = W;
  perp_contact* contact = NULL;
  perp_result* result = NULL;
  const double* dr;
  OK(perp_contact_create(PERP_INTERFACE, 3, 1, &W, pushed, mu, &contact, &error));
  OK(perp_contact_sensitivity(NULL, contact, r, 0, NULL, NULL, NULL, NULL, &result, &error));
  CHECK_SAYING(perp_result_integer(result, "known") == 1, perp_result_text(result, "message", 0));
  CHECK(strcmp(perp_result_text(result, "status", 0), "Differentiable") == 0);
  CHECK(strcmp(perp_result_text(result, "regions", 0), "slip") == 0);
  CHECK(perp_result_integer(result, "directions") == 4 && perp_result_length(result, "dr") == 12);
  dr = perp_result_reals(result, "dr");
  CHECK_NEAR(dr[0], -2, 1e-12);
  CHECK_NEAR(dr[4], 1, 1e-12);
  CHECK_NEAR(dr[7], -2, 1e-12);
  CHECK_NEAR(perp_result_reals(result, "du")[7], -1, 1e-12);
  perp_result_free(result);
  perp_contact_free(contact);
  OK(perp_contact_create(PERP_INTERFACE, 3, 1, &W, at_the_edge, mu, &contact, &error));
  dq.columns = 1;
  dq.form = PERP_DENSE_COLUMNS;
  dq.start = dq.index = NULL;
  dq.value = dq_of_push;
  OK(perp_contact_sensitivity(NULL, contact, r, 1, &dq, NULL, NULL, NULL, &result, &error));
  CHECK(perp_result_integer(result, "known") == 0 && perp_result_integers(result, "degenerate")[0] == 0);
  perp_result_free(result);
  OK(perp_contact_sensitivity(NULL, contact, r, 1, &dq, NULL, NULL, up, &result, &error));
  CHECK(strcmp(perp_result_text(result, "status", 0), "Directional") == 0);
  CHECK_NEAR(perp_result_reals(result, "du")[1], 1, 1e-12);
  perp_result_free(result);
  REFUSED(perp_contact_sensitivity(NULL, contact, r, 2, &dq, NULL, NULL, NULL, &result, &error), PERP_BAD_ARGUMENT,
          "dq: ");
  REFUSED(perp_contact_sensitivity(NULL, contact, NULL, 1, &dq, NULL, NULL, NULL, &result, &error), PERP_BAD_ARGUMENT,
          "r: is NULL");
  perp_contact_free(contact);
}

/* Two of check_mass(), the second pushed beyond friction, by hand: it slides on with 0.9 - 0.5 m/s. Catches steps taken
   wrongly, and a start that decides more than where the next step begins. */
static void side_by_side(void) {
  const double W[9] = {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5}, both[6] = {-1, 0.1, 0, -1, 0.9, 0}, wrong[1] = {-1};
  const perp_varying all_W = {W, 0}, all_q = {both, 3}, all_mu = {mu, 0}, bad_mu = {wrong, 0};
  const double expected[6] = {2, -0.2, 0, 2, -1, 0};
  double r[6], u[6], residual[2];
  int32_t status[2];
  int k, i;
  perp_contact_batch* batch = NULL;
  OK(perp_contact_batch_create(PERP_INTERFACE, NULL, 2, NULL, &batch, &error));
  for (k = 0; k < 3; ++k) {
    OK(perp_contact_batch_step(batch, 3, 1, &all_W, &all_q, &all_mu, k, r, u, status, residual, &error));
    for (i = 0; i < 6; ++i) CHECK_NEAR(r[i], expected[i], 1e-6);
    CHECK_NEAR(u[4], 0.4, 1e-6);
    for (i = 0; i < 2; ++i) CHECK(status[i] == PERP_SOLVED && residual[i] <= 1e-8);
  }
  OK(perp_contact_batch_step(batch, 3, 1, &all_W, &all_q, &all_mu, 0, NULL, NULL, NULL, NULL, &error));
  REFUSED(perp_contact_batch_step(batch, 3, 1, &all_W, &all_q, &bad_mu, 0, r, u, NULL, NULL, &error), PERP_BAD_ARGUMENT,
          "mu: entry [0] is -1");
  REFUSED(perp_contact_batch_step(batch, 3, 1, NULL, &all_q, &all_mu, 0, r, u, NULL, NULL, &error), PERP_BAD_ARGUMENT,
          "W: is NULL");
  REFUSED(perp_contact_batch_step(NULL, 3, 1, &all_W, &all_q, &all_mu, 0, r, u, NULL, NULL, &error), PERP_BAD_ARGUMENT,
          "batch: ");
  perp_contact_batch_free(batch);
  REFUSED(perp_contact_batch_create(PERP_INTERFACE, NULL, 2, "glockr", &batch, &error), PERP_BAD_ARGUMENT, "variant: ");
  CHECK(batch == NULL);
  perp_contact_batch_free(NULL);
}

int main(void) {
  side_by_side();
  derivatives();
  scenes();
  given_as_W();
  rolls();
  given_as_bodies();
  from_a_file();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
