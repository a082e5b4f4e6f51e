#include <brdfs/fit/ltc_table.h>

#include <brdfs/catalog/tables.h>
#include <brdfs/rows/spec.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace hshfit::brdfs {
namespace {

std::vector<std::string> split(const std::string& words) {
    std::vector<std::string> parts;
    for (std::size_t from = 0; from <= words.size();) {
        const std::size_t to = std::min(words.find(',', from), words.size());
        parts.push_back(words.substr(from, to - from));
        from = to + 1;
    }
    return parts;
}

const Model& modelOf(const std::string& spec) {
    const std::string name = spec.substr(0, spec.find(':'));
    std::vector<std::string_view> known;
    for (const Model& model : models()) {
        if (model.name == name) return model;
        known.push_back(model.name);
    }
    throw UsageError(fmt::format("'{}': tables are made of models, one by one{}; known: {}", name,
                                 suggestion(name, known), joined(known)));
}

const Parameter& runningParameter(const Model& model, const std::string& name) {
    std::vector<std::string_view> known;
    for (const Parameter& parameter : model.parameters) {
        if (parameter.kind == Parameter::Kind::choice) continue;
        if (parameter.name == name) return parameter;
        known.push_back(parameter.name);
    }
    throw UsageError(fmt::format("{} has no number '{}' to run over roughness{}; it has {}",
                                 model.name, name, suggestion(name, known), joined(known)));
}

/// Makes the model with its running parameters at a value.
class Family {
public:
    Family(const std::string& spec, const LtcTableOptions& options)
        : spec_(spec), names_(split(options.parameter)), mapping_(options.mapping) {
        const Model& model = modelOf(spec);
        least_ = -HUGE_VAL;
        most_ = HUGE_VAL;
        for (const std::string& name : names_) {
            const Parameter& parameter = runningParameter(model, name);
            least_ = std::max(least_, parameter.min);
            most_ = std::min(most_, parameter.max);
            refuseGiven(name);
        }
        requireTableable(*make(valueAt(0.5)), model);
    }

    double valueAt(double roughness) const {
        const double square = roughness * roughness;
        const double value = mapping_ == RoughnessMapping::square   ? square
                             : mapping_ == RoughnessMapping::linear ? roughness
                                                                    : 2 / (square * square) - 2;
        return std::clamp(value, least_, most_);
    }

    std::unique_ptr<Brdf> make(double value) const {
        std::string spec = spec_;
        for (const std::string& name : names_)
            spec += fmt::format("{}{}={}", spec.find(':') == std::string::npos ? ':' : ',', name,
                                value);
        return openModel(spec);
    }

private:
    void refuseGiven(const std::string& name) const {
        for (const char* before : {":", ","}) {
            if (spec_.find(before + name + "=") == std::string::npos) continue;
            throw UsageError(
                fmt::format("'{}': {} runs over roughness; leave it out", spec_, name));
        }
    }

    static void requireTableable(const Brdf& brdf, const Model& model) {
        const Laws& laws = brdf.laws();
        if (!laws.isotropic || !laws.mirrorSymmetric)
            throw UsageError(fmt::format("{}: tables are of isotropic models", brdf.name()));
        if (brdf.channels().count() != 1)
            throw UsageError(fmt::format(
                "{}: a table holds one lobe for all colours; give {} one value for each of its "
                "parameters",
                brdf.name(), model.name));
    }

    std::string spec_;
    std::vector<std::string> names_;
    RoughnessMapping mapping_;
    double least_, most_;
};

/// Follows the lobe from one elevation to the next.
LtcLobe follow(const Brdf& brdf, const LtcLobe& from, double cosineFrom, double cosineTo) {
    LtcLobe lobe = from;
    double cosine = cosineFrom;
    const int steps = std::max(1, static_cast<int>(std::ceil(std::log2(cosineFrom / cosineTo))));
    for (int step = 1; step <= steps; ++step) {
        const double next =
            step == steps ? cosineTo
                          : cosineFrom * std::pow(cosineTo / cosineFrom, double(step) / steps);
        const double turn = std::acos(cosine) - std::acos(next);
        const double theta = std::acos(next);
        lobe = fitLtc(brdf, directionFromAngles(theta, 0), turned(lobe.ltc, turn));
        cosine = next;
    }
    return lobe;
}

/// wo at the normal: the best of three widths about the one that the model states.
LtcLobe fitUpright(const Brdf& brdf) {
    const Direction normal{0, 0, 1};
    const Ltc first = firstLtc(brdf, normal);
    LtcLobe best;
    for (const double factor : {1.0, 0.4, 2.5}) {
        Ltc start = first;
        start.d *= factor;
        const LtcLobe lobe = fitLtc(brdf, normal, start, {.symmetric = true});
        if (best.magnitude == 0 || lobe.error < best.error * (1 - 1e-6)) best = lobe;
    }
    return best;
}

}  // namespace

double ltcCosine(int row, int size) {
    const double x = static_cast<double>(row) / (size - 1);
    return std::max(1 - x * x, std::cos(1.57));
}

LtcTable fitLtcTable(const std::string& spec, const LtcTableOptions& options) {
    const int size = options.size;
    if (size < 2 || size > 1024)
        throw UsageError(fmt::format("{} cells a side: from 2 to 1024 are possible", size));
    const Family family(spec, options);
    LtcTable table{.spec = spec, .parameter = options.parameter, .size = size};
    for (int k = 0; k < size; ++k) {
        table.values.push_back(family.valueAt(static_cast<double>(k) / (size - 1)));
        table.cosines.push_back(ltcCosine(k, size));
    }
    table.cells.resize(static_cast<std::size_t>(size) * size);
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(0, size, [&](int column) {
        const auto brdf = family.make(table.values[column]);
        LtcLobe lobe = fitUpright(*brdf);
        for (int row = 0; row < size; ++row) {
            if (row > 0) lobe = follow(*brdf, lobe, table.cosines[row - 1], table.cosines[row]);
            table.cells[row * size + column] = lobe;
            const std::size_t count = ++done;
            if (options.progress) options.progress(count, table.cells.size());
        }
    });
    return table;
}

LtcTable::Summary LtcTable::summary() const {
    Summary result;
    for (const LtcLobe& lobe : cells) {
        result.meanError += lobe.error / static_cast<double>(cells.size());
        result.meanMisplaced += lobe.misplaced / static_cast<double>(cells.size());
        result.largestError = std::max(result.largestError, lobe.error);
        result.largestUncertainty = std::max(result.largestUncertainty, lobe.uncertainty);
        result.unsettled += lobe.converged ? 0 : 1;
    }
    return result;
}

}  // namespace hshfit::brdfs
