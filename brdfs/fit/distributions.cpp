#include <brdfs/fit/distributions.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <cmath>

namespace hshfit::brdfs {

double chiSquareProbability(double chiSquare, double degrees) {
    return degrees > 0 ? boost::math::gamma_q(degrees / 2, chiSquare / 2) : 1;
}

double chiSquareQuantile(double probability, double degrees) {
    return 2 * boost::math::gamma_p_inv(degrees / 2, probability);
}

double studentBound(double probability, double degrees) {
    using boost::math::complement;
    if (std::isinf(degrees))
        return boost::math::quantile(complement(boost::math::normal(), probability / 2));
    return boost::math::quantile(complement(boost::math::students_t(degrees), probability / 2));
}

}  // namespace hshfit::brdfs
