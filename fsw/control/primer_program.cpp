#include "fsw/control/primer_program.h"

#include <algorithm>

#include "fsw/math/cholesky.h"
#include "fsw/math/math.h"

namespace vbar::fsw::control {
namespace {

using Cone = PrimerProgram::Cone;

constexpr double kInteriorShare = 0.9;  ///< contact value to which a start shrinks lambda
constexpr double kStepShare = 0.99;     ///< part of the distance to a cone's boundary that a step may cover
constexpr double kUnboundedStep = 1e300;

/// lower triangle of m += factor * (g g' + 2 (g w)(g w)')
void add_scaled_gramian(const Matrix63& g, const Vector3& w, double factor, Matrix6& m) {
  const Vector6 gw = g * w;
  for (int c = 0; c < 6; ++c) {
    for (int r = c; r < 6; ++r) {
      m(r, c) += factor * (g(r, 0) * g(c, 0) + g(r, 1) * g(c, 1) + g(r, 2) * g(c, 2) + 2.0 * gw(r) * gw(c));
    }
  }
}

/// Largest |primer| of the active set at `lambda`.
double largest_contact(const PrimerProgram& program) {
  double largest = 0.0;
  for (std::size_t k = 0; k < program.count; ++k) {
    largest = std::max(largest, (program.active[k].effect.transpose() * program.lambda).squaredNorm());
  }
  return math::sqrt(largest);
}

/// Slacks and Nesterov-Todd scaling of a cone; false if its point has left the interior.
bool scale_cone(const ActiveImpulse& impulse, Cone& cone) {
  cone.slack = 1.0 - cone.primer.squaredNorm();
  const double dv_norm = impulse.dv.norm();
  cone.multiplier_slack = (impulse.bound - dv_norm) * (impulse.bound + dv_norm);
  if (!(cone.slack > 0.0 && cone.multiplier_slack > 0.0)) return false;

  const double s_norm = math::sqrt(cone.slack);
  const double z_norm = math::sqrt(cone.multiplier_slack);
  const Vector3 s = cone.primer / s_norm;
  const Vector3 z = -impulse.dv / z_norm;
  const double s0 = 1.0 / s_norm;
  const double z0 = impulse.bound / z_norm;
  const double gamma2 = 2.0 * math::sqrt(0.5 * (1.0 + s0 * z0 + s.dot(z)));
  cone.w0 = (s0 + z0) / gamma2;
  cone.w = (s - z) / gamma2;
  cone.scale = math::sqrt(s_norm / z_norm);
  cone.scale_inv_squared = z_norm / s_norm;
  return true;
}

/// A point or direction of a second-order cone, (head, tail).
struct ConeVector {
  double head;
  Vector3 tail;
};

/// W v, or W^-1 v for sign = -1 (its scaling point is (w0, -w) and the factor 1/eta).
ConeVector apply_scaling(const Cone& cone, double head, const Vector3& tail, double sign) {
  const double factor = sign > 0.0 ? cone.scale : 1.0 / cone.scale;
  const double wt = sign * cone.w.dot(tail);
  const double along = sign * (head + wt / (1.0 + cone.w0));
  return {factor * (cone.w0 * head + wt), factor * (tail + along * cone.w)};
}

/// W^-2 (0, tail).
ConeVector apply_inverse_scaling_squared(const Cone& cone, const Vector3& tail) {
  const double wt = cone.w.dot(tail);
  return {-cone.scale_inv_squared * 2.0 * cone.w0 * wt, cone.scale_inv_squared * (tail + 2.0 * wt * cone.w)};
}

/// Longest step with |primer + step primer_step| <= 1.
double longest_primer_step(const Cone& cone) {
  const double b = cone.primer.dot(cone.primer_step);
  const double denominator = b + math::sqrt(b * b + cone.primer_step.squaredNorm() * cone.slack);
  return denominator > 0.0 ? cone.slack / denominator : kUnboundedStep;
}

/// Longest step that keeps the multiplier (bound, -dv) in its cone.
double longest_multiplier_step(const ActiveImpulse& impulse, const Cone& cone) {
  const double a = cone.step0 * cone.step0 - cone.step.squaredNorm();
  const double b = impulse.bound * cone.step0 + impulse.dv.dot(cone.step);
  const double discriminant = b * b - a * cone.multiplier_slack;
  if (discriminant < 0.0) return kUnboundedStep;
  const double denominator = math::sqrt(discriminant) - b;
  return denominator > 0.0 ? cone.multiplier_slack / denominator : kUnboundedStep;
}

/// Steps of all cones for a step of lambda; the longest common step that stays inside, at most 1.
double cone_steps(PrimerProgram& program, const Vector6& lambda_step) {
  double longest = 1.0 / kStepShare;
  for (std::size_t k = 0; k < program.count; ++k) {
    const ActiveImpulse& impulse = program.active[k];
    Cone& cone = program.cone[k];
    cone.primer_step = impulse.effect.transpose() * lambda_step;
    const ConeVector curved = apply_inverse_scaling_squared(cone, cone.primer_step);
    cone.step0 = cone.correction0 - impulse.bound - curved.head;
    cone.step = cone.correction + impulse.dv - curved.tail;
    longest = std::min({longest, longest_primer_step(cone), longest_multiplier_step(impulse, cone)});
  }
  return kStepShare * longest;
}

/// Mehrotra's correction from the predictor's steps: W^-1 (l \ (sigma mu e - (W^-1 ds) o (W dz))), l = W z the scaled
/// point.
void correct_cone(const ActiveImpulse& impulse, double centring, Cone& cone) {
  const ConeVector point = apply_scaling(cone, impulse.bound, -impulse.dv, 1.0);
  const ConeVector ds = apply_scaling(cone, 0.0, cone.primer_step, -1.0);
  const double dz_head = -point.head - ds.head;
  const Vector3 dz_tail = -point.tail - ds.tail;

  const double head = centring - (ds.head * dz_head + ds.tail.dot(dz_tail));
  const Vector3 tail = -(ds.head * dz_tail + dz_head * ds.tail);
  const double determinant = math::sqrt(cone.slack * cone.multiplier_slack);  // point.head^2 - |point.tail|^2
  const double quotient_head = (point.head * head - point.tail.dot(tail)) / determinant;
  const Vector3 quotient_tail = (tail - quotient_head * point.tail) / point.head;

  const ConeVector correction = apply_scaling(cone, quotient_head, quotient_tail, -1.0);
  cone.correction0 = correction.head;
  cone.correction = correction.tail;
}

struct Gap {
  double complementarity = 0.0;  ///< sum s'z
  double cost = 0.0;             ///< sum of bounds
  double residual = 0.0;         ///< |w - sum G u|
};

Gap measure_gap(const PrimerProgram& program) {
  Gap gap;
  Vector6 residual = program.target;
  for (std::size_t k = 0; k < program.count; ++k) {
    const ActiveImpulse& impulse = program.active[k];
    residual -= impulse.effect * impulse.dv;
    gap.cost += impulse.bound;
    gap.complementarity += impulse.bound - impulse.dv.dot(program.cone[k].primer);
  }
  gap.residual = residual.norm();
  return gap;
}

/// One predictor-corrector step.
Status newton_step(PrimerProgram& program, double complementarity) {
  Matrix6 normal = Matrix6::Zero();
  for (std::size_t k = 0; k < program.count; ++k) {
    if (!scale_cone(program.active[k], program.cone[k])) return Status::kSingular;
    add_scaled_gramian(program.active[k].effect, program.cone[k].w, program.cone[k].scale_inv_squared, normal);
    program.cone[k].correction0 = 0.0;
    program.cone[k].correction.setZero();
  }
  const math::Cholesky6 factor(normal);
  if (!factor.ok()) return Status::kSingular;

  const double predictor_length = std::min(1.0, cone_steps(program, factor.solve(program.target)));
  const double remaining = 1.0 - predictor_length;
  const double centring = remaining * remaining * remaining * complementarity / static_cast<double>(program.count);
  Vector6 right = program.target;
  for (std::size_t k = 0; k < program.count; ++k) {
    correct_cone(program.active[k], centring, program.cone[k]);
    right += program.active[k].effect * program.cone[k].correction;
  }
  const Vector6 lambda_step = factor.solve(right);
  const double length = cone_steps(program, lambda_step);
  if (!math::is_finite(length) || !math::is_finite(lambda_step.sum())) return Status::kNotFinite;

  program.lambda += length * lambda_step;
  for (std::size_t k = 0; k < program.count; ++k) {
    program.active[k].bound += length * program.cone[k].step0;
    program.active[k].dv -= length * program.cone[k].step;
  }
  return Status::kOk;
}

/// Changes the multipliers so that they reach `missing` more, mainly the large ones, and stay inside their cones.
Status meet_target(PrimerProgram& program, const Vector6& missing) {
  Matrix6 gramian = Matrix6::Zero();
  for (std::size_t k = 0; k < program.count; ++k) {
    const ActiveImpulse& impulse = program.active[k];
    add_scaled_gramian(impulse.effect, Vector3::Zero(), impulse.bound * impulse.bound, gramian);
  }
  const math::Cholesky6 factor(gramian);
  if (!factor.ok()) return Status::kSingular;
  const Vector6 multiplier = factor.solve(missing);
  for (std::size_t k = 0; k < program.count; ++k) {
    ActiveImpulse& impulse = program.active[k];
    impulse.dv += impulse.bound * impulse.bound * (impulse.effect.transpose() * multiplier);
    impulse.bound = std::max(impulse.bound, impulse.dv.norm() + (1.0 - kInteriorShare) * impulse.bound);
  }
  return Status::kOk;
}

}  // namespace

Status start_primer_program(PrimerProgram& program) {
  Matrix6 gramian = Matrix6::Zero();
  for (std::size_t k = 0; k < program.count; ++k) {
    add_scaled_gramian(program.active[k].effect, Vector3::Zero(), 1.0, gramian);
  }
  const math::Cholesky6 factor(gramian);
  if (!factor.ok()) return Status::kSingular;
  program.lambda = factor.solve(program.target);

  double largest_dv = 0.0;
  for (std::size_t k = 0; k < program.count; ++k) {
    program.active[k].dv = program.active[k].effect.transpose() * program.lambda;
    largest_dv = std::max(largest_dv, program.active[k].dv.norm());
  }
  for (std::size_t k = 0; k < program.count; ++k) {
    program.active[k].bound = program.active[k].dv.norm() + largest_dv;
  }
  program.lambda *= kInteriorShare / largest_contact(program);
  return math::is_finite(program.lambda.sum()) ? Status::kOk : Status::kSingular;
}

Status restart_primer_program(PrimerProgram& program) {
  const double contact = largest_contact(program);
  if (contact > kInteriorShare) program.lambda *= kInteriorShare / contact;

  // On the central path u = mu y / (1 - |y|^2); mu is the one with the smallest residual.
  Vector6 reached = Vector6::Zero();
  for (std::size_t k = 0; k < program.count; ++k) {
    ActiveImpulse& impulse = program.active[k];
    const Vector3 primer = impulse.effect.transpose() * program.lambda;
    impulse.bound = 1.0 / (1.0 - primer.squaredNorm());
    impulse.dv = impulse.bound * primer;
    reached += impulse.effect * impulse.dv;
  }
  const double mu = program.target.dot(reached) / reached.squaredNorm();
  if (!(mu > 0.0) || !math::is_finite(mu)) return Status::kSingular;
  for (std::size_t k = 0; k < program.count; ++k) {
    program.active[k].bound *= mu;
    program.active[k].dv *= mu;
  }
  return meet_target(program, program.target - mu * reached);
}

PrimerProgramEnd solve_primer_program(PrimerProgram& program, double relative_gap, int max_steps) {
  for (int step = 0; step <= max_steps; ++step) {
    for (std::size_t k = 0; k < program.count; ++k) {
      program.cone[k].primer = program.active[k].effect.transpose() * program.lambda;
    }
    const Gap gap = measure_gap(program);
    if (gap.complementarity <= relative_gap * gap.cost && gap.residual <= relative_gap) return {Status::kOk, step};
    if (step == max_steps) break;
    const Status status = newton_step(program, gap.complementarity);
    if (status != Status::kOk) return {status, step};
  }
  return {Status::kDidNotConverge, max_steps};
}

}  // namespace vbar::fsw::control
