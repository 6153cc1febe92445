// Integer least squares on the double differences of satellite geometry: 100 sessions of every kind from strong to
// weak, in turn; one iteration is one problem, from float ambiguities to the two best integer vectors. RTKLIB's, where
// Debian's librtklib-dev is installed, on the same problems.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "fsw/gnss/lambda.h"
#include "tests/unit/fsw/gnss/ambiguity_problems.h"

#ifdef VBAR_HAVE_RTKLIB
#include "tests/peers/lambda/rtklib_lambda.h"
#endif

namespace {

using namespace vbar::fsw::gnss;

std::vector<problems::Problem> sessions(Eigen::Index n) {
  problems::Random random(static_cast<std::uint64_t>(n));
  std::vector<problems::Problem> drawn;
  for (int i = 0; i < 100; ++i) {
    drawn.push_back(problems::draw(problems::random_session_covariance(n, random), random));
  }
  return drawn;
}

template <class Solve>
void solve_in_turn(benchmark::State& state, const Solve& solve) {
  const std::vector<problems::Problem> drawn = sessions(state.range(0));
  std::size_t next = 0;
  for (auto _ : state) {
    const problems::Problem& problem = drawn[next];
    next = (next + 1) % drawn.size();
    benchmark::DoNotOptimize(solve(problem));
  }
}

void vbar_lambda(benchmark::State& state) {
  solve_in_turn(state, [](const problems::Problem& problem) {
    return resolve_ambiguities({problem.ambiguities.data(), problem.size()},
                               {problem.covariance.data(), problem.size() * problem.size()});
  });
}
BENCHMARK(vbar_lambda)->Name("lambda/vbar")->Arg(8)->Arg(12)->Arg(20)->Arg(24);

#ifdef VBAR_HAVE_RTKLIB
void rtklib_lambda(benchmark::State& state) {
  Eigen::MatrixXd fixed(state.range(0), 2);
  std::array<double, 2> norm2{};
  solve_in_turn(state, [&](const problems::Problem& problem) {
    return vbar::peers::rtklib_lambda(problem.ambiguities, problem.covariance, fixed, norm2);
  });
}
BENCHMARK(rtklib_lambda)->Name("lambda/rtklib")->Arg(8)->Arg(12)->Arg(20)->Arg(24);
#endif

}  // namespace
