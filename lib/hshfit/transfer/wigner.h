#pragma once

#include <vector>

namespace hshfit::inline transfer {

/// Wigner 3j symbols of whole l for all l1 at once: values[l1 - first] = (l1 l2 l3; m1 m2 m3) with
/// m1 = -m2 - m3 and l1 from first = max(|l2 - l3|, |m1|) to l2 + l3.
///
/// By the three-term recurrence in l1 of Schulten & Gordon (1975, J. Math. Phys. 16, 1961), as
/// ratios of neighbours from both ends to where the symbols stop growing and as values between
/// (Luscombe & Luban 1998, Phys. Rev. E 57, 7274), normalised by sum (2 l1 + 1) values^2 = 1.
/// Nothing overflows; symbols below 2.3e-308 are 0. The error, relative to the largest symbol of
/// the family, is below 1e-13 for l to 100 and 1e-12 for l to 1000. The object's memory is used
/// again by the next call. Throws UsageError unless |m2| <= l2 and |m3| <= l3.
struct WignerFamily {
    int first = 0;
    std::vector<double> values;

    void compute(int l2, int l3, int m2, int m3);

private:
    std::vector<double> down_;
};

/// One symbol, 0 by a selection rule included. A family is far cheaper than its symbols one by one.
double wigner3j(int l1, int l2, int l3, int m1, int m2, int m3);

}  // namespace hshfit::inline transfer
