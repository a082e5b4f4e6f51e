#include <hshfit/quadrature/ring_points.h>

#include <hshfit/quadrature/azimuth_tables.h>

namespace hshfit::inline quadrature {

void RingPoints::start(const HemisphereGrid::Panel& panel) {
    const std::size_t azimuths = panel.azimuths.spacing.azimuths;
    const double step = 2 * pi / static_cast<double>(azimuths);
    cosine_.resize(azimuths);
    sine_.resize(azimuths);
    step_.resize(azimuths);
    for (std::size_t j = 0; j < azimuths; ++j) {
        const SpreadAzimuth at =
            spreadAzimuth((static_cast<double>(j) + 0.5) * step, panel.azimuths.spacing);
        const double cx = panel.azimuths.centreX, cy = panel.azimuths.centreY;
        cosine_[j] = cx * at.cosine - cy * at.sine;
        sine_[j] = cy * at.cosine + cx * at.sine;
        step_[j] = step * at.weight;
    }
    for (auto* values : {&x_, &y_, &z_, &weights_}) values->resize(azimuths);
}

void RingPoints::move(const HemisphereGrid& grid, std::size_t ring) {
    const double sine = grid.sines[ring], height = grid.elevations[ring].mu;
    for (std::size_t j = 0; j < count(); ++j) {
        x_[j] = sine * cosine_[j];
        y_[j] = sine * sine_[j];
        z_[j] = height;
        weights_[j] = grid.weights[ring] * step_[j];
    }
}

}  // namespace hshfit::inline quadrature
