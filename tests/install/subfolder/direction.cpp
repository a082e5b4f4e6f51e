#include <hshfit/brdf/directions.h>

#include <cmath>

int main() {
    const hshfit::Direction d = hshfit::directionFromAngles(hshfit::pi / 3, 0);
    return std::abs(d.z - 0.5) < 1e-15 ? 0 : 1;
}
