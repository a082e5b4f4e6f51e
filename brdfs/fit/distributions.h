#pragma once

namespace hshfit::brdfs {

/// The probability of a chi-square of at least `chiSquare` with so many degrees of freedom, the
/// regularised incomplete gamma function Q(degrees / 2, chiSquare / 2); 1 without any.
double chiSquareProbability(double chiSquare, double degrees);

/// The value that a chi-square is below with the given probability, from 0 to less than 1.
double chiSquareQuantile(double probability, double degrees);

/// The size that a variable of Student's distribution exceeds, on both sides together, with the
/// given probability. Infinite `degrees`: the normal distribution.
double studentBound(double probability, double degrees);

}  // namespace hshfit::brdfs
