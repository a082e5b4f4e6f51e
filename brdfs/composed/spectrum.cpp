#include <brdfs/composed/spectrum.h>

#include <algorithm>
#include <cassert>

namespace hshfit::brdfs {
namespace {

bool same(const Lobe& a, const Lobe& b) {
    return a.about == b.about && a.width == b.width && a.spread == b.spread &&
           a.axis.x == b.axis.x && a.axis.y == b.axis.y && a.axis.z == b.axis.z;
}

}  // namespace

Spectrum::Spectrum(std::vector<Line> lines, std::string name)
    : lines_(std::move(lines)), name_(std::move(name)), laws_{true, true, true, true, true} {
    assert(!lines_.empty());
    std::vector<double> wavelengths;
    for (const Line& line : lines_) {
        assert(line.brdf->channels().kind == Channels::Kind::grey);
        const Laws& own = line.brdf->laws();
        laws_.nonNegative &= own.nonNegative;
        laws_.reciprocal &= own.reciprocal;
        laws_.isotropic &= own.isotropic;
        laws_.mirrorSymmetric &= own.mirrorSymmetric;
        laws_.energyConserving &= own.energyConserving;
        wavelengths.push_back(line.wavelength);
    }
    channels_ = Channels::spectral(std::move(wavelengths));
}

void Spectrum::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    for (std::size_t c = 0; c < lines_.size(); ++c)
        lines_[c].brdf->eval(wo, wi, out + c * wi.count);
}

void Spectrum::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    std::fill_n(covered, wi.count, static_cast<unsigned char>(1));
    std::vector<unsigned char> own(wi.count);
    for (const Line& line : lines_) {
        line.brdf->coverage(wo, wi, own.data());
        for (std::size_t k = 0; k < wi.count; ++k) covered[k] = covered[k] && own[k];
    }
}

std::vector<Lobe> Spectrum::lobes(const Direction& wo) const {
    std::vector<Lobe> all;
    for (const Line& line : lines_)
        for (const Lobe& lobe : line.brdf->lobes(wo))
            if (std::ranges::none_of(all, [&](const Lobe& known) { return same(known, lobe); }))
                all.push_back(lobe);
    return all;
}

std::vector<double> Spectrum::kinks(const Direction& wo) const {
    std::vector<double> all;
    for (const Line& line : lines_)
        for (const double height : line.brdf->kinks(wo)) all.push_back(height);
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::vector<KinkCurve> Spectrum::kinkCurves(const Direction& wo) const {
    return kinkCurvesOf(*lines_.front().brdf, wo);
}

std::vector<double> Spectrum::outgoingKinks(const Direction& wi) const {
    return outgoingKinksOf(*lines_.front().brdf, wi);
}

std::vector<KinkCurve> Spectrum::outgoingKinkCurves(const Direction& wi) const {
    return outgoingKinkCurvesOf(*lines_.front().brdf, wi);
}

int Spectrum::squareLevels() const {
    int most = 0;
    for (const Line& line : lines_) most = std::max(most, squareLevelsOf(*line.brdf));
    return most;
}

double Spectrum::defaultTolerance() const {
    double largest = 0;
    for (const Line& line : lines_) largest = std::max(largest, line.brdf->defaultTolerance());
    return largest;
}

std::vector<Fact> Spectrum::facts() const {
    std::vector<Fact> facts;
    const std::vector<std::string> names = channels_.names();
    for (std::size_t c = 0; c < lines_.size(); ++c)
        facts.push_back({names[c], lines_[c].brdf->name()});
    return facts;
}

void Spectrum::checkIntact() const {
    for (const Line& line : lines_) line.brdf->checkIntact();
}

}  // namespace hshfit::brdfs
