#include <brdfs/fit/instrument/instrument_json.h>

#include <nlohmann/json.hpp>

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::ordered_json;

Json apertureJson(const Aperture& aperture) {
    Json json = {{"shape", aperture.shape == Aperture::Shape::cone ? "cone" : "rectangle"},
                 {"half_angle", degrees(aperture.half)}};
    if (aperture.shape == Aperture::Shape::rectangle)
        json["half_angle_across"] = degrees(aperture.across);
    return json;
}

Json termJson(const InstrumentTerm& term, const std::vector<double>& values) {
    return {{"fitted", term.fitted()}, {"values", values}};
}

Json zeroJson(const AngleZero& zero, const std::vector<double>& values) {
    return {{"width", zero.width},
            {"of", zero.of == AngleZero::Of::scan ? "scan" : "campaign"},
            {"values", values}};
}

const char* nameOf(Slit::Shape shape) {
    if (shape == Slit::Shape::box) return "box";
    return shape == Slit::Shape::triangle ? "triangle" : "gauss";
}

}  // namespace

Json instrumentJson(const FittedInstrument& fitted) {
    using From = InstrumentTerm::From;
    const Instrument& own = fitted.instrument;
    Json json = Json::object();
    if (own.source.finite()) json["source_aperture"] = apertureJson(own.source);
    if (own.detector.finite()) json["detector_aperture"] = apertureJson(own.detector);
    if (own.averages())
        json["averages"] = {{"tolerance", own.tolerance},
                            {"largest_change", fitted.averageChange},
                            {"nodes", fitted.nodes},
                            {"most_nodes_of_a_sample", fitted.mostNodes}};
    if (own.slit.finite())
        json["bandwidth"] = {{"shape", nameOf(own.slit.shape)}, {"width", own.slit.width}};
    if (own.offset.from != From::nothing) json["offset"] = termJson(own.offset, fitted.offset);
    if (own.dark.from != From::nothing) {
        json["dark"] = termJson(own.dark, fitted.dark);
        json["dark"]["over_cosines"] = brdfs::nameOf(own.darkOver);
    }
    if (own.stray.from != From::nothing)
        json["stray"] = {{"fitted", own.stray.fitted()},
                         {"value", fitted.stray},
                         {"largest_change", fitted.strayChange}};
    if (own.incidenceZero.fitted())
        json["incidence_zero"] = zeroJson(own.incidenceZero, fitted.incidenceZeros);
    if (own.detectorZero.fitted())
        json["detector_zero"] = zeroJson(own.detectorZero, fitted.detectorZeros);
    if (own.scales) {
        json["scales"] = {{"values", fitted.scales}};
        if (own.scaleWidth > 0) json["scales"]["width"] = own.scaleWidth;
    }
    return json;
}

}  // namespace hshfit::brdfs
