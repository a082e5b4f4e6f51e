#include <hshfit/brdf/directions.h>

#include <cmath>

namespace hshfit::inline brdf {

Direction directionFromAngles(double theta, double phi) {
    const double s = std::sin(theta);
    return {s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
}

double polarAngle(const Direction& d) {
    return std::atan2(std::hypot(d.x, d.y), d.z);
}

double azimuth(const Direction& d) {
    return d.x == 0 && d.y == 0 ? 0.0 : std::atan2(d.y, d.x);
}

double oneMinusZ(const Direction& d) {
    return d.z > 0 ? (d.x * d.x + d.y * d.y) / (1 + d.z) : 1 - d.z;
}

Elevation<double> elevationOf(const Direction& d) {
    return {d.z, d.z > 0 ? oneMinusZ(d) : 1 - d.z};
}

Direction rotateAboutZ(const Direction& d, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * d.x - s * d.y, s * d.x + c * d.y, d.z};
}

DirectionPair fromHalfDifference(double thetaHalf, double phiHalf, double thetaDifference,
                                 double phiDifference) {
    const Direction half = directionFromAngles(thetaHalf, 0);
    const Direction difference = directionFromAngles(thetaDifference, phiDifference);
    // wi = R_z(phi_h) R_y(theta_h) difference; wo has the opposite azimuth about the half vector.
    const double along = difference.z, across = difference.x;
    const DirectionPair pair{
        {half.z * across + half.x * along, difference.y, half.z * along - half.x * across},
        {half.x * along - half.z * across, -difference.y, half.z * along + half.x * across}};
    if (phiHalf == 0) return pair;
    return {rotateAboutZ(pair.wi, phiHalf), rotateAboutZ(pair.wo, phiHalf)};
}

}  // namespace hshfit::inline brdf
