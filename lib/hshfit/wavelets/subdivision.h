#pragma once

#include <hshfit/brdf/directions.h>

#include <array>

namespace hshfit::wavelets {

/// A spherical triangle, anticlockwise as seen from outside, and its solid angle.
struct Triangle {
    std::array<Direction, 3> corners;
    double area;
};

/// The solid angle by its tangent (Eriksson 1990), for a triangle smaller than a hemisphere;
/// relative error some 1e-15 over the length of the sides in radians.
double areaOf(const std::array<Direction, 3>& corners);

/// The octahedron: the four octants above the xy plane, from the x axis on, then those below.
std::array<Triangle, 8> octants();

/// Four children: the central one, then those at corners 0, 1 and 2, which have equal areas (the
/// area-isometry that a symmetric orthogonal Haar basis needs: Lessig & Fiume 2008). New corners
/// lie on the edges. Equal areas leave one degree of freedom; here the outer areas are the largest
/// for which such corners exist. This choice, ours, keeps every symmetry of the triangle: edges are
/// halved where it has three equal sides, and in the limit of small triangles.
std::array<Triangle, 4> subdivided(const Triangle& triangle);

}  // namespace hshfit::wavelets
