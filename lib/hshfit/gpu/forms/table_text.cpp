#include <hshfit/gpu/forms/table_text.h>

#include <hshfit/gpu/shader_data.h>

#include <string>
#include <string_view>

namespace hshfit::embedded {
extern const std::string_view form_table_place;
}  // namespace hshfit::embedded

namespace hshfit::gpu::inline forms {

using kainjow::mustache::data;
using kainjow::mustache::partial;

void setTablePlace(const FunctionTable& table, data& page) {
    const auto number = [&](const char* name, double value) {
        page.set(name, shaderNumber(value));
    };
    const HalfwayAxes::Constants& axes = table.axes().constants();
    const auto half = static_cast<double>(table.size().half),
               plane = static_cast<double>(table.size().plane),
               horizon = static_cast<double>(table.size().horizon), rows = plane * horizon;
    number("leastSquare", TablePlace::leastSquare);
    number("leastSine2", TablePlace::leastSine2);
    number("halfStraight", 1 - TablePlace::halfBend);
    number("halfBend", TablePlace::halfBend);
    number("planeStraight", 1 - TablePlace::planeBend);
    number("planeBend", TablePlace::planeBend);
    number("perLog", axes.perLog);
    number("stretch", axes.xx * axes.xx);
    number("lastHorizon", horizon - 1);
    number("lastCell", horizon - 2);
    number("halfScale", (half - 1) / half);
    number("halfFirst", 0.5 / half);
    number("planeScale", (plane - 1) / rows);
    number("planeFirst", 0.5 / rows);
    number("nodeScale", plane / rows);
    std::string body(embedded::form_table_place);
    if (body.ends_with('\n')) body.pop_back();
    page.set("tablePlaceBody", data(partial([body] { return body; })));
}

}  // namespace hshfit::gpu::inline forms
