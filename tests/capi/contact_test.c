// SPDX-License-Identifier: Apache-2.0
/* Contact problems through capi/perp.h: would catch blocks in another order, M and H mixed up, options that do not
   arrive, a judge that is not contact's. The first problem's solution is by hand. */
#include <stdlib.h>

#include "check.h"
#include "perp.h"

static perp_error error;

/* A mass of 2 kg falls with 1 m/s and slides with 0.1 m/s, mu = 0.5, W = I / 2: r_N = 2 stops it, and friction up to
   1 N s stops the slide, for which 0.2 are enough: stick. */
static const double q[] = {-1, 0.1, 0};
static const double mu[] = {0.5};

static void check_mass(perp_contact* contact) {
  perp_contact_result* result = NULL;
  double number = -1;
  int32_t accepted = -1;
  const double nothing[] = {0, 0, 0};
  CHECK(perp_contact_dimension(contact) == 3 && perp_contact_contacts(contact) == 1);
  CHECK_NEAR(perp_contact_q(contact)[0], -1, 1e-15);
  CHECK(perp_contact_mu(contact)[0] == 0.5);
  OK(perp_contact_solve(NULL, contact, NULL, &result, &error));
  CHECK_SAYING(perp_contact_result_solved(result), perp_contact_result_message(result));
  CHECK(perp_contact_result_status(result) == PERP_SOLVED && perp_contact_result_size(result) == 3);
  CHECK_NEAR(perp_contact_result_r(result)[0], 2, 1e-6);
  CHECK_NEAR(perp_contact_result_r(result)[1], -0.2, 1e-6);
  CHECK_NEAR(perp_contact_result_u(result)[0], 0, 1e-6);
  CHECK(perp_contact_result_states(result)[0] == PERP_STICK);
  CHECK(perp_contact_result_solved_by(result)[0] != '\0');
  OK(perp_contact_result_number(result, "siconos", &number, &error));
  CHECK(number <= 1e-8);
  OK(perp_contact_result_number(result, "iterations", &number, &error));
  REFUSED(perp_contact_result_number(result, "no such", &number, &error), PERP_BAD_ARGUMENT, "no such");
  OK(perp_contact_judge(contact, perp_contact_result_r(result), 1e-8, &accepted, NULL, &error));
  CHECK(accepted == 1);
  OK(perp_contact_judge(contact, nothing, 1e-8, &accepted, &number, &error));
  CHECK(accepted == 0 && number > 0.1);
  perp_contact_result_free(result);
}

static void given_as_W(void) {
  const int32_t start[] = {0, 1, 2, 3};
  const int32_t row[] = {0, 1, 2};
  const double value[] = {0.5, 0.5, 0.5};
  const double bad_mu[] = {-1};
  perp_contact* contact = NULL;
  OK(perp_contact_create_int32(PERP_INTERFACE, 3, 1, start, row, value, q, mu, &contact, &error));
  check_mass(contact);
  perp_contact_free(contact);
  REFUSED(perp_contact_create_int32(PERP_INTERFACE, 4, 1, start, row, value, q, mu, &contact, &error),
          PERP_BAD_ARGUMENT, "dimension: 4");
  REFUSED(perp_contact_create_int32(PERP_INTERFACE, 3, 1, start, row, value, q, bad_mu, &contact, &error),
          PERP_BAD_ARGUMENT, "mu: entry 1 is -1");
  REFUSED(perp_contact_create_int32(PERP_INTERFACE, 3, 1, start, NULL, value, q, mu, &contact, &error),
          PERP_BAD_ARGUMENT, "W_row: is NULL");
  REFUSED(perp_contact_create_int32(PERP_INTERFACE, 3, 1, start, row, value, q, NULL, &contact, &error),
          PERP_BAD_ARGUMENT, "mu: is NULL");
  CHECK(contact == NULL);
}

/* M = 2 I, H = I: W = I / 2; f = 0, w = q. */
static void given_as_bodies(void) {
  const int64_t start[] = {0, 1, 2, 3};
  const int64_t row[] = {0, 1, 2};
  const double M[] = {2, 2, 2};
  const double singular[] = {2, 0, 2};
  const double H[] = {1, 1, 1};
  const double f[] = {0, 0, 0};
  perp_contact* contact = NULL;
  OK(perp_contact_condense_int64(PERP_INTERFACE, 3, 1, 3, start, row, M, start, row, H, f, q, mu, &contact, &error));
  check_mass(contact);
  perp_contact_free(contact);
  REFUSED(perp_contact_condense_int64(PERP_INTERFACE, 3, 1, 3, start, row, singular, start, row, H, f, q, mu, &contact,
                                      &error),
          PERP_BAD_ARGUMENT, "M");
  CHECK(contact == NULL);
}

static void from_a_file(void) {
  static const char* const variants[] = {NULL,           "glocker",       "glocker+homotopy",
                                         "glocker+path", "inner:8+lemke", "frictionless"};
  size_t v;
  perp_contact* contact = NULL;
  perp_contact_result* result = NULL;
  perp_solver* solver = NULL;
  OK(perp_solver_create(PERP_INTERFACE, &solver, &error));
  OK(perp_contact_read(PERP_INTERFACE, PERP_SOURCE_DIR "/data/contact/arch-9.hdf5", &contact, &error));
  for (v = 0; v < sizeof variants / sizeof *variants; ++v) {
    OK(perp_contact_solve(solver, contact, variants[v], &result, &error));
    CHECK_SAYING(perp_contact_result_solved(result), perp_contact_result_message(result));
    perp_contact_result_free(result);
  }
  REFUSED(perp_contact_solve(solver, contact, "glocker+nonsense", &result, &error), PERP_BAD_ARGUMENT, "variant: ");
  /* A limit that is reached: without time nothing is solved. */
  OK(perp_solver_set(solver, "convergence_tolerance", "1e-11", &error));
  OK(perp_solver_set(solver, "time_limit", "1e-9", &error));
  OK(perp_contact_solve(solver, contact, "glocker+homotopy", &result, &error));
  CHECK_SAYING(perp_contact_result_status(result) == PERP_TIME_LIMIT, perp_contact_result_message(result));
  perp_contact_result_free(result);
  OK(perp_solver_clear_options(solver, &error));
  perp_solver_interrupt(solver);
  OK(perp_contact_solve(solver, contact, "glocker+homotopy", &result, &error));
  CHECK_SAYING(perp_contact_result_status(result) == PERP_INTERRUPTED, perp_contact_result_message(result));
  perp_contact_result_free(result);
  /* Options of the methods, and one that the method has not. */
  OK(perp_solver_set(solver, "psor_omega", "1.5", &error));
  REFUSED(perp_contact_solve(solver, contact, "glocker+homotopy", &result, &error), PERP_BAD_OPTION, "psor_omega");
  perp_solver_free(solver);
  perp_contact_free(contact);
  REFUSED(perp_contact_read(PERP_INTERFACE, "/no/such.hdf5", &contact, &error), PERP_BAD_FILE, "/no/such.hdf5");
}

int main(void) {
  given_as_W();
  given_as_bodies();
  from_a_file();
  return failed_checks == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
