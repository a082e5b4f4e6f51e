#pragma once

#include <hshfit/rotation/rotation.h>

#include <cmath>
#include <random>
#include <vector>

namespace hshfit::test {

/// Random numbers with a seed of their own, so that a failure can be repeated.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    double normal() { return normal_(engine_); }

    std::vector<double> vector(std::size_t count) {
        std::vector<double> result(count);
        for (double& value : result) value = normal();
        return result;
    }
    Direction direction() {
        const Direction d{normal(), normal(), normal()};
        const double length = std::sqrt(dot(d, d));
        return {d.x / length, d.y / length, d.z / length};
    }
    /// One draw a statement: compilers differ in the order of arguments.
    Rotation rotation() {
        const double z = normal();
        const double y = normal();
        const double x = normal();
        return Rotation::fromQuaternion(normal(), x, y, z);
    }

private:
    std::mt19937_64 engine_;
    std::normal_distribution<double> normal_;
};

inline double normOf(const std::vector<double>& v) {
    double sum = 0;
    for (double x : v) sum += x * x;
    return std::sqrt(sum);
}

inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

}  // namespace hshfit::test
