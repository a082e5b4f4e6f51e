#include <brdfs/measured/no_values.h>
#include <brdfs/measured/pbsdf.h>
#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/tensor_file.h>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace hshfit::brdfs {
namespace {

using Field = TensorFile::Field;

void checkNodes(const TensorFile& file, const Field& field, const std::vector<double>& nodes,
                double least, double most) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i] >= least && nodes[i] <= most && (i == 0 || nodes[i] > nodes[i - 1])) continue;
        file.fail(field, fmt::format("value {} is {}, expected ascending values from {:.6g} to "
                                     "{:.6g}",
                                     i, nodes[i], least, most));
    }
}

/// The `count` nodes of one angle of M; evenly spaced if the field is empty.
std::vector<double> loadAngles(const TensorFile& file, std::string_view name, std::uint64_t count,
                               double least, double most, bool& assumed) {
    const Field& field = file.field(name);
    if (field.shape.empty() || field.shape.back() != count || field.shape.size() > 2 ||
        (field.count != 0 && field.count != count)) {
        file.fail(field, fmt::format("has the shape {}, expected 1 x {} as field M",
                                     shapeText(field.shape), count));
    }
    std::vector<double> nodes;
    if (field.count == 0) {
        assumed = true;
        for (std::uint64_t i = 0; i < count; ++i) {
            nodes.push_back(least + (most - least) * static_cast<double>(i) /
                                        static_cast<double>(count - 1));
        }
        return nodes;
    }
    const std::vector<float> values = file.floats(field, field.shape.size());
    nodes.assign(values.begin(), values.end());
    // pi rounded to float may be above pi.
    checkNodes(file, field, nodes, least - 1e-6, most + 1e-6);
    return nodes;
}

std::vector<double> loadWavelengths(const TensorFile& file, std::uint64_t count) {
    const Field& field = file.field("wvls");
    if (field.type != TensorFile::Type::u16 || field.shape.size() != 1 || field.count != count) {
        file.fail(field, fmt::format("is {} of type {}, expected {} of type u16",
                                     shapeText(field.shape), typeName(field.type), count));
    }
    std::vector<std::uint16_t> values(count);
    std::memcpy(values.data(), file.raw(field).data(), count * sizeof values[0]);
    std::vector<double> nodes(values.begin(), values.end());
    checkNodes(file, field, nodes, 1, 65535);
    return nodes;
}

/// The elements at some places of every matrix.
std::vector<float> loadElements(const TensorFile& file, const Field& field,
                                const std::vector<std::size_t>& places) {
    constexpr std::size_t matrix = 16;
    const auto bytes = file.raw(field);
    std::vector<float> values(field.count / matrix * places.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t number = i / places.size() * matrix + places[i % places.size()];
        std::memcpy(&values[i], bytes.data() + number * sizeof(float), sizeof(float));
        if (std::isinf(values[i])) {
            file.fail(field, fmt::format("value {} (offset {}) is infinite", number,
                                         field.offset + number * sizeof(float)));
        }
    }
    return values;
}

struct Between {
    std::size_t lower = 0;
    double fraction = 0;
};

Between locate(const std::vector<double>& nodes, double value) {
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, value);
    const auto lower = static_cast<std::size_t>(above - nodes.begin()) - 1;
    const double part = (value - nodes[lower]) / (nodes[lower + 1] - nodes[lower]);
    return {lower, std::clamp(part, 0.0, 1.0)};
}

/// Rusinkiewicz's angles: with u = wi + wo and v = wi - wo,
///     theta_d = atan2(|v|, |u|),  phi_d = atan2(2 (wo x wi)_z, -|u| v_z) as n x h has it.
struct Angles {
    double thetaHalf, thetaDifference, phiDifference;

    Angles(const Direction& wo, const Direction& wi) {
        const double ux = wi.x + wo.x, uy = wi.y + wo.y, uz = wi.z + wo.z;
        const double vx = wi.x - wo.x, vy = wi.y - wo.y, vz = wi.z - wo.z;
        const double across = ux * ux + uy * uy, u = std::sqrt(across + uz * uz);
        const double v = std::sqrt(vx * vx + vy * vy + vz * vz);
        thetaHalf = std::atan2(std::sqrt(across), uz);
        thetaDifference = std::atan2(v, u);
        // phi_d is undefined where h is the normal or wi = wo, and set to 0
        // there.
        phiDifference =
            across > 1e-28 && v > 1e-14 ? std::atan2(2 * (wo.x * wi.y - wi.x * wo.y), -u * vz) : 0;
    }
};

}  // namespace

struct PbsdfBrdf::Corners {
    std::array<std::size_t, 8> vertex{};
    std::array<double, 8> weight{};  ///< sum 1, or all 0 where no corner has a value
    bool any = false;
};

PbsdfBrdf::PbsdfBrdf(std::span<const unsigned char> bytes, std::string name,
                     MuellerElements elements)
    : name_(std::move(name)), elements_(std::move(elements)), places_(elements_.places()) {
    if (places_[0] != 0) places_.insert(places_.begin(), 0);
    const TensorFile file(bytes, name_);
    const Field& field = file.field("M");
    const auto& shape = field.shape;
    const bool valid = field.type == TensorFile::Type::f32 && shape.size() == 6 && shape[0] >= 2 &&
                       shape[1] >= 2 && shape[2] >= 2 && shape[3] >= 1 && shape[4] == 4 &&
                       shape[5] == 4;
    if (!valid) {
        file.fail(field, fmt::format("has the type {} and the shape {}, expected f32 and phi_d x "
                                     "theta_d x theta_h x wavelengths x 4 x 4 (angles: 2 or more)",
                                     typeName(field.type), shapeText(shape)));
    }
    phiDifference_ = loadAngles(file, "phi_d", shape[0], -pi, pi, anglesAssumed_);
    thetaDifference_ = loadAngles(file, "theta_d", shape[1], 0, pi / 2, anglesAssumed_);
    thetaHalf_ = loadAngles(file, "theta_h", shape[2], 0, pi / 2, anglesAssumed_);
    channels_ = elements_.channels(Channels::spectral(loadWavelengths(file, shape[3])));
    values_ = loadElements(file, field, places_);
    laws_.nonNegative = elements_.arePositive();
    laws_.isotropic = true;
}

std::unique_ptr<PbsdfBrdf> PbsdfBrdf::open(const std::string& path, MuellerElements elements) {
    const MappedFile file(path);
    const std::string name = elements.isReflectance() ? path : path + ":mueller=" + elements.text();
    try {
        auto brdf = std::make_unique<PbsdfBrdf>(file.bytes(), name, std::move(elements));
        file.checkIntact();
        return brdf;
    } catch (const InputError&) {
        file.checkIntact();  // reports a file that was removed or cut while it was read
        throw;
    }
}

std::size_t PbsdfBrdf::vertex(std::size_t p, std::size_t d, std::size_t h) const {
    return (p * thetaDifference_.size() + d) * thetaHalf_.size() + h;
}

bool PbsdfBrdf::hasValue(std::size_t vertex) const {
    bool zero = true;
    for (std::size_t w = 0; w < wavelengths(); ++w) {
        const float* values = at(vertex, w);
        if (std::any_of(values, values + planes(), [](float v) { return std::isnan(v); }))
            return false;
        zero = zero && values[0] == 0;
    }
    return !zero;
}

PbsdfBrdf::Corners PbsdfBrdf::corners(const Direction& wo, const Direction& wi) const {
    const Angles angles(wo, wi);
    const Between p = locate(phiDifference_, angles.phiDifference);
    const Between d = locate(thetaDifference_, angles.thetaDifference);
    const Between h = locate(thetaHalf_, angles.thetaHalf);
    Corners corners;
    double sum = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        const std::size_t ip = i / 4, id = i / 2 % 2, ih = i % 2;
        corners.vertex[i] = vertex(p.lower + ip, d.lower + id, h.lower + ih);
        const double weight = (ip != 0 ? p.fraction : 1 - p.fraction) *
                              (id != 0 ? d.fraction : 1 - d.fraction) *
                              (ih != 0 ? h.fraction : 1 - h.fraction);
        if (!(weight > 0) || !hasValue(corners.vertex[i])) continue;
        corners.weight[i] = weight;
        sum += weight;
    }
    corners.any = sum > 0;
    for (double& weight : corners.weight) weight = corners.any ? weight / sum : 0;
    return corners;
}

void PbsdfBrdf::eval(const Direction& wo, DirectionBatch wi, double* out) const {
    const std::size_t n = channels_.count();
    std::fill_n(out, n * wi.count, 0.0);
    if (!(wo.z > 0)) return;
    for (std::size_t k = 0; k < wi.count; ++k) {
        if (!(wi.z[k] > 0)) continue;
        const Corners near = corners(wo, {wi.x[k], wi.y[k], wi.z[k]});
        if (!near.any) continue;
        for (std::size_t w = 0; w < wavelengths(); ++w) {
            const MuellerElements::Matrix matrix = matrixAt(near, w);
            for (std::size_t e = 0; e < elements_.size(); ++e)
                out[(e * wavelengths() + w) * wi.count + k] = elements_.value(e, matrix);
        }
    }
}

MuellerElements::Matrix PbsdfBrdf::matrixAt(const Corners& corners, std::size_t wavelength) const {
    MuellerElements::Matrix matrix{};
    for (std::size_t i = 0; i < 8; ++i) {
        if (!(corners.weight[i] > 0)) continue;
        const float* from = at(corners.vertex[i], wavelength);
        for (std::size_t p = 0; p < planes(); ++p)
            matrix[places_[p]] += corners.weight[i] * double{from[p]};
    }
    return matrix;
}

void PbsdfBrdf::coverage(const Direction& wo, DirectionBatch wi, unsigned char* covered) const {
    for (std::size_t k = 0; k < wi.count; ++k) {
        const bool above = wo.z > 0 && wi.z[k] > 0;
        covered[k] = above && corners(wo, {wi.x[k], wi.y[k], wi.z[k]}).any ? 1 : 0;
    }
}

void PbsdfBrdf::addNode(std::size_t vertex, Census& census) const {
    if (!hasValue(vertex)) {
        census.invalid += channels_.count();
        return;
    }
    Corners node;
    node.vertex[0] = vertex, node.weight[0] = 1;
    for (std::size_t w = 0; w < wavelengths(); ++w) {
        const MuellerElements::Matrix matrix = matrixAt(node, w);
        // Values of M00 below 0 are counted as they are.
        if (elements_.isReflectance()) census.add(matrix[0]);
        for (std::size_t e = 0; e < elements_.size() && !elements_.isReflectance(); ++e)
            census.add(elements_.value(e, matrix));
    }
}

Census PbsdfBrdf::census() const {
    const std::size_t n = channels_.count();
    Census census;
    census.values = values_.size() / planes() / wavelengths() * n;
    for (std::size_t p = 0; p < phiDifference_.size(); ++p) {
        for (std::size_t d = 0; d < thetaDifference_.size(); ++d) {
            for (std::size_t h = 0; h < thetaHalf_.size(); ++h) {
                // Heights of both directions: cos cos -+ sin sin cos(phi_d).
                const double along = std::cos(thetaHalf_[h]) * std::cos(thetaDifference_[d]);
                const double across = std::sin(thetaHalf_[h]) * std::sin(thetaDifference_[d]) *
                                      std::fabs(std::cos(phiDifference_[p]));
                const std::size_t node = vertex(p, d, h);
                if (along - across < 1e-6)
                    census.belowHorizon += n;
                else
                    addNode(node, census);
            }
        }
    }
    return census;
}

std::vector<Axis> PbsdfBrdf::axes() const {
    std::vector<Axis> axes;
    const auto add = [&](std::string name, std::string unit, std::vector<double> nodes) {
        double gap = 0;
        for (std::size_t i = 1; i < nodes.size(); ++i) gap = std::max(gap, nodes[i] - nodes[i - 1]);
        axes.push_back(
            {std::move(name), std::move(unit), nodes.size(), nodes.front(), nodes.back(), gap});
    };
    const auto addAngles = [&](std::string name, std::vector<double> nodes) {
        for (double& node : nodes) node = degrees(node);
        add(std::move(name), "degrees", std::move(nodes));
    };
    addAngles("theta_half", thetaHalf_);
    addAngles("theta_difference", thetaDifference_);
    addAngles("phi_difference", phiDifference_);
    add("wavelength", "nm", channels_.wavelengths);
    return axes;
}

std::vector<Fact> PbsdfBrdf::facts() const {
    return {{"format", "pbsdf"},
            {"dimensions", fmt::format("{} x {} x {} x {}", phiDifference_.size(),
                                       thetaDifference_.size(), thetaHalf_.size(), wavelengths())},
            {"angles_assumed_evenly_spaced", anglesAssumed_},
            muellerFact(elements_)};
}

const Format& pbsdfFormat() {
    static const Format format{
        .name = "pbsdf",
        .help = "Mueller matrices over half and difference angles, isotropic, spectral",
        .extension = ".pbsdf",
        .recognises =
            [](std::span<const unsigned char> head, std::uint64_t) {
                // rgl has the same container; the names in the table of contents tell them apart.
                const std::string_view text(reinterpret_cast<const char*>(head.data()),
                                            head.size());
                return text.starts_with(TensorFile::magic) &&
                       text.find("theta_d") != std::string_view::npos &&
                       text.find("vndf") == std::string_view::npos;
            },
        .parameters = {muellerParameter()},
        .open = [](const std::string& path, const Parameters& parameters) -> std::unique_ptr<Brdf> {
            auto brdf = PbsdfBrdf::open(path, muellerElements(parameters));
            refuseWithoutValues(brdf->census(), path);
            return brdf;
        },
    };
    return format;
}

}  // namespace hshfit::brdfs
