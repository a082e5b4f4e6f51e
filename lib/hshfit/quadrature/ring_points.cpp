#include <hshfit/quadrature/ring_points.h>

#include <hshfit/quadrature/azimuth_tables.h>

namespace hshfit::inline quadrature {
namespace {

/// The azimuths of a ring with kinks once around: nodes of the half circle, then their mirror
/// images.
void cutNodes(const CutRing& ring, std::vector<double>& t, std::vector<double>& weights) {
    ring.nodes(t, weights);
    for (std::size_t j = ring.size(); j-- > 0;) {
        t.push_back(2 * pi - t[j]);
        weights.push_back(weights[j]);
    }
}

}  // namespace

/// Azimuths that all rings of a panel share.
void RingPoints::takeEqual(const HemisphereGrid::Panel& panel) {
    const std::size_t azimuths = panel.azimuths.spacing.azimuths;
    const double step = 2 * pi / static_cast<double>(azimuths);
    std::vector<double> t(azimuths), weights(azimuths, step);
    for (std::size_t j = 0; j < azimuths; ++j) t[j] = (static_cast<double>(j) + 0.5) * step;
    take(panel, t, weights);
}

void RingPoints::take(const HemisphereGrid::Panel& panel, const std::vector<double>& t,
                      const std::vector<double>& weights) {
    for (auto* values : {&cosine_, &sine_, &step_, &x_, &y_, &z_, &weights_})
        values->resize(t.size());
    const double cx = panel.azimuths.centreX, cy = panel.azimuths.centreY;
    for (std::size_t j = 0; j < t.size(); ++j) {
        const SpreadAzimuth at = spreadAzimuth(t[j], panel.azimuths.spacing);
        cosine_[j] = cx * at.cosine - cy * at.sine;
        sine_[j] = cy * at.cosine + cx * at.sine;
        step_[j] = weights[j] * at.weight;
    }
}

bool RingPoints::next() {
    while (panel_ < grid_.panels.size() &&
           next_ >= grid_.panels[panel_].firstRing + grid_.panels[panel_].rings)
        ++panel_;
    if (panel_ == grid_.panels.size()) return false;
    const HemisphereGrid::Panel& panel = grid_.panels[panel_];
    const std::size_t ring = next_++;
    if (!panel.cuts.empty()) {
        std::vector<double> t, weights;
        cutNodes(panel.cuts[ring - panel.firstRing], t, weights);
        take(panel, t, weights);
    } else if (ring == panel.firstRing) {
        takeEqual(panel);
    }
    const double sine = grid_.sines[ring], height = mu();
    for (std::size_t j = 0; j < count(); ++j) {
        x_[j] = sine * cosine_[j];
        y_[j] = sine * sine_[j];
        z_[j] = height;
        weights_[j] = grid_.weights[ring] * step_[j];
    }
    return true;
}

}  // namespace hshfit::inline quadrature
