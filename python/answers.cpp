#include "answers.h"

#include "arrays.h"

#include <hshfit/pages/picture_error_json.h>

#include <pybind11/stl.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace hshfit::python {

py::object poorDict(const std::optional<jobs::Poor>& poor) {
    if (!poor) return py::none();
    py::dict out;
    out["reason"] = poor->reason;
    out["better"] = poor->better;
    if (!poor->toTry.empty()) out["to_try"] = poor->toTry;
    return out;
}

py::object pictureDict(const std::optional<PictureError>& picture) {
    if (!picture) return py::none();
    return fromJson(pictureErrorJson(*picture));
}

py::dict angles(const Direction& d) {
    py::dict out;
    out["theta"] = degrees(polarAngle(d));
    out["phi"] = degrees(azimuth(d));
    return out;
}

py::dict metricsDict(const std::vector<MetricValue>& metrics) {
    py::dict rows;
    for (const MetricValue& metric : metrics) {
        py::dict row;
        row["value"] = orNaN(metric.value);
        row["error"] = metric.value ? metric.error : std::numeric_limits<double>::quiet_NaN();
        row["reason"] = metric.reason;
        if (metric.wi) row["wi"] = angles(*metric.wi);
        if (metric.wo) row["wo"] = angles(*metric.wo);
        rows[py::str(std::string(metric.metric->name))] = row;
    }
    return rows;
}

py::dict convertedDict(const jobs::Converted& done) {
    py::dict out;
    out["input"] = done.input;
    out["written"] = done.written;
    out["altered"] = done.altered;
    out["bytes"] = done.bytes;
    out["error"] = done.error;
    out["error_over"] = done.errorOver;
    out["picture"] = pictureDict(done.picture);
    out["poor"] = poorDict(done.poor);
    if (done.repairs) {
        py::dict repairs;
        for (const auto& count : done.repairs->counts) {
            py::dict row;
            row["values"] = done.repairs->evaluated;
            row["changed"] = count.changed;
            row["left"] = count.left;
            if (const auto& check = count.check) {
                row["filled_by_angle"] =
                    std::vector<std::uint64_t>(count.byAngle.begin(), count.byAngle.end());
                py::dict own;
                own["pairs"] = check->pairs;
                own["reach"] = check->reach;
                own["noise"] = check->noise;
                own["median"] = check->median;
                own["percentile_95"] = check->percentile95;
                own["largest"] = check->largest;
                row["check"] = own;
            }
            repairs[py::str(std::string(count.name))] = row;
        }
        out["repairs"] = repairs;
    }
    if (done.loss) {
        py::dict loss;
        loss["outgoing"] = done.loss->outgoing;
        loss["metrics"] = metricsDict(done.loss->metrics);
        out["loss"] = loss;
    }
    return out;
}

py::dict energyDict(const Energy& energy) {
    py::dict out;
    out["value"] = energy.value;
    out["error"] = energy.error;
    out["finite"] = energy.finite;
    out["reason"] = energy.reason;
    return out;
}

}  // namespace hshfit::python
