#include "tests/peers/rtklib/rtklib_lambda.h"

// RTKLIB 2.4.3 manual, "int lambda(int n, int m, const double *a, const double *Q, double *F, double *s)": n
// ambiguities, m solutions; column-major Q (n x n) and F (n x m); 0 if solved.
extern "C" int lambda(int n, int m, const double* a, const double* Q, double* F, double* s);

// The library expects these of the program around it: progress of its own programs.
extern "C" int showmsg(const char* /*format*/, ...) {  // NOLINT(cert-dcl50-cpp): C's signature
  return 0;
}
extern "C" void settspan() {}
extern "C" void settime() {}

namespace vbar::peers {

bool rtklib_lambda(const Eigen::VectorXd& ambiguities, const Eigen::MatrixXd& covariance, Eigen::MatrixXd& fixed,
                   std::array<double, 2>& norm2) {
  return lambda(static_cast<int>(ambiguities.size()), 2, ambiguities.data(), covariance.data(), fixed.data(),
                norm2.data()) == 0;
}

}  // namespace vbar::peers
