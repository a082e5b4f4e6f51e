// Broken coefficient files end in InputError with one line that names the file, and no more.

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>

#include "lib/coefficient_files/coefficient_samples.h"

#include <cstring>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include <ImfChannelList.h>
#include <ImfFloatVectorAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

using namespace hshfit;
using Json = nlohmann::json;
using samples::Folder;

namespace {

/// The message with which `read` refuses `name`, after that name; empty if it reads.
template <class Read>
std::string refusalBy(Read read, const std::string& name) {
    try {
        read();
    } catch (const InputError& error) {
        const std::string message = error.what();
        EXPECT_TRUE(message.starts_with(name)) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_LT(message.size(), name.size() + 400);
        return message.substr(name.size());
    }
    return {};
}

std::string refusal(const std::string& path) {
    return refusalBy([&] { readCoefficients(path); }, path);
}

std::string refusalOfJson(const std::string& bytes) {
    return refusalBy([&] { coefficientsFromJson(bytes, "name"); }, "name");
}

std::string refusalOfExr(const std::string& bytes) {
    return refusalBy([&] { coefficientsFromExr(bytes, "name"); }, "name");
}

void expectRefused(const std::string& path, const std::string& fragment) {
    const std::string message = refusal(path);
    EXPECT_FALSE(message.empty()) << "was read; expected: " << fragment;
    EXPECT_NE(message.find(fragment), std::string::npos) << message << "\nexpected: " << fragment;
}

Coefficients sample() {
    return samples::make(OutgoingSet::parabolic(4, 5), Channels::rgb(), Quantity::brdf, 2, 3);
}

class CoefficientFileAttack : public ::testing::Test {
protected:
    const Folder folder;
    const std::string json = folder / "c.json", exr = folder / "c.exr";

    Json written() {
        writeCoefficients(sample(), json);
        return Json::parse(samples::contentOf(json));
    }
    void expectJsonRefused(const std::string& content, const std::string& fragment) {
        samples::put(json, content);
        expectRefused(json, fragment);
    }
};

TEST_F(CoefficientFileAttack, FilesOfOtherFormatsAreRefused) {
    expectRefused(folder / "none.json", "no such file");
    expectRefused(folder.path().string(), "is not a regular file");
    for (const std::string name : {"c.json", "c.exr", "c.bin"}) {
        samples::put(folder / name, "");
        expectRefused(folder / name, "is empty");
        EXPECT_FALSE(looksLikeCoefficients(folder / name));
        samples::put(folder / name, std::string(100, '\0'));
        EXPECT_FALSE(refusal(folder / name).empty());
        EXPECT_FALSE(looksLikeCoefficients(folder / name));
    }
    expectRefused(folder / "c.bin", "neither hshfit JSON nor OpenEXR");
    expectRefused(exr, "76 2f 31 01");
    expectJsonRefused("{\"format\":\"hshfit-report\",\"version\":1}",
                      "'format' is 'hshfit-report'");
    EXPECT_FALSE(looksLikeCoefficients(json));
    EXPECT_FALSE(looksLikeCoefficients(folder.path().string()));
    EXPECT_FALSE(looksLikeCoefficients(folder / "none.json"));
}

TEST_F(CoefficientFileAttack, EveryTruncationIsRefused) {
    writeCoefficients(sample(), json);
    writeCoefficients(sample(), exr);
    for (const auto& [refuse, path] : {std::pair(&refusalOfJson, json), {&refusalOfExr, exr}}) {
        const std::string whole = samples::contentOf(path);
        ASSERT_GT(whole.size(), 1000u);
        ASSERT_EQ(refuse(whole), "");
        const std::size_t end = whole.find_last_not_of(" \n") + 1;  // JSON ends with a line feed
        for (std::size_t size = 0; size < end; ++size) {
            ASSERT_FALSE(refuse(whole.substr(0, size)).empty()) << path << " cut to " << size;
        }
    }
}

TEST_F(CoefficientFileAttack, FlippedBytesNeverEscapeAsAnotherError) {
    writeCoefficients(sample(), json);
    writeCoefficients(sample(), exr);
    std::mt19937_64 random(20240607);
    for (const auto& [refuse, path] : {std::pair(&refusalOfJson, json), {&refusalOfExr, exr}}) {
        const std::string whole = samples::contentOf(path);
        for (int round = 0; round < 10000; ++round) {
            std::string broken = whole;
            for (int i = 0; i <= round % 3; ++i) {
                broken[random() % broken.size()] = static_cast<char>(random());
            }
            refuse(broken);  // reads or refuses; anything else ends the test
            exrSaysCoefficients(broken);
        }
    }
}

TEST_F(CoefficientFileAttack, EveryMissingKeyIsRefused) {
    const Json good = written();
    for (const auto& [key, value] : good.items()) {
        Json bad = good;
        bad.erase(key);
        expectJsonRefused(bad.dump(), "'" + key + "'");
        if (!value.is_object()) continue;
        for (const auto& [inner, ignored] : value.items()) {
            Json worse = good;
            worse[key].erase(inner);
            expectJsonRefused(worse.dump(), "'" + key + "." + inner + "' is missing");
        }
    }
}

TEST_F(CoefficientFileAttack, EveryWrongTypeIsRefused) {
    const Json good = written();
    const Json kinds[] = {nullptr, true, "word", 12345, Json::array({1}), Json::object()};
    const std::set<std::string> nullable{"energy", "energy_error", "error", "tolerance"};
    for (const auto& [key, value] : good.items()) {
        for (const Json& kind : kinds) {
            if (kind.type() == value.type() || (kind.is_number() && value.is_number())) continue;
            if (kind.is_null() && nullable.count(key)) continue;
            Json bad = good;
            bad[key] = kind;
            expectJsonRefused(bad.dump(), "'" + key);
        }
    }
}

TEST_F(CoefficientFileAttack, WrongValuesAreRefused) {
    const Json good = written();
    const struct {
        const char* pointer;
        Json value;
        const char* fragment;
    } cases[] = {
        {"/version", 2, "written by a newer hshfit"},
        {"/version", 0, "has to be an integer from 1"},
        {"/version", 1.5, "has to be an integer from 1"},
        {"/basis/name", "gsh", "known: hsh"},
        {"/basis/name", std::string(100000, 'x'), "known: hsh"},
        {"/basis/order", 0, "'basis.order' is 0"},
        {"/basis/order", -3, "'basis.order' is -3"},
        {"/basis/order", 1e9, "'basis.order' is 1"},
        {"/basis/order", 1e300, "'basis.order' is 1e+300"},
        {"/basis/order", 2.5, "'basis.order' is 2.5"},
        {"/basis/order", 3, "has 4 values for each channel; order 3 needs 9"},
        {"/basis/index", "l+m", "l*(l+1)+m"},
        {"/quantity", "radiance", "'brdf' or 'brdf_cosine'"},
        {"/channel_kind", "cmyk", "'grey', 'rgb', 'spectral' or 'named'"},
        {"/channel_kind", "grey", "array of 1 names"},
        {"/channel_kind", "spectral", "'wavelengths_nm' is missing"},
        {"/channels", {"G", "R", "B"}, "has to be [\"R\",\"G\",\"B\"]"},
        {"/channels", {"R", "G"}, "array of 3 names"},
        {"/outgoing/map", "cube", "'parabolic', 'elevations' or 'direction'"},
        {"/outgoing/map", "elevations", "'outgoing.count' is missing"},
        {"/outgoing/width", 5, "states 25 outgoing directions, but the file has 20"},
        {"/outgoing/width", 2000000000, "'outgoing.width' is 2000000000"},
        {"/outgoing/height", 65536, "states 262144 outgoing directions, but the file has 20"},
        {"/outgoing/width", 0, "'outgoing.width' is 0"},
        {"/outgoing/inset_texels", 2, "'outgoing.inset_texels' has to be 1"},
        {"/outgoing/horizon_ring_degrees", 0.1, "'outgoing.horizon_ring_degrees' has to be 1"},
        {"/coefficients", Json::array(),
         "states 20 outgoing directions, but 'coefficients' is missing or empty"},
        {"/coefficients/3/1/2", nullptr, "coefficients[3][1][2] is not a number"},
        {"/coefficients/3/1/2", "1", "coefficients[3][1][2] is not a number"},
        {"/coefficients/3/1/2", Json::array(), "[outgoing][channel][slot]"},
        {"/coefficients/3/1", {1, 2, 3}, "coefficients[3][1] has 3 values, those before it 4"},
        {"/coefficients/3/1", 5, "[outgoing][channel][slot]"},
        {"/coefficients/3", {{1, 2, 3, 4}}, "coefficients[3] has 1 channels, those before it 3"},
        {"/coefficients/3", Json::object(), "[outgoing][channel][slot]"},
    };
    for (const auto& [pointer, value, fragment] : cases) {
        SCOPED_TRACE(pointer);
        Json bad = good;
        bad[Json::json_pointer(pointer)] = value;
        expectJsonRefused(bad.dump(), fragment);
    }
}

TEST_F(CoefficientFileAttack, InvalidJsonIsRefused) {
    written();
    const std::string good = samples::contentOf(json);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string bad = good;
        const auto at = bad.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return bad.replace(at, from.size(), to);
    };
    expectJsonRefused(with("\"version\": 1", "\"version\": 1, \"version\": 1"), "appears twice");
    expectJsonRefused(with("\"order\":2", "\"order\":2,\"order\":3"), "'order' appears twice");
    expectJsonRefused(with("[[", "[[1e999,"), "not valid JSON");
    expectJsonRefused(with("[[", "[[NaN,"), "not valid JSON");
    expectJsonRefused(with("\"error\": ", "\"error\": -Infinity"), "not valid JSON");
    expectJsonRefused(good + "{}", "not valid JSON");
    for (const std::string deep : {"[", "{\"a\":"}) {
        std::string nested = "{\"a\":";
        for (int i = 0; i < 1000000; ++i) nested += deep;
        expectJsonRefused(nested, "nested too deeply");
    }
    expectJsonRefused(with("\"coefficients\": [", "\"coefficients\": [[[[[[[[[["),
                      "[outgoing][channel][slot]");
    samples::put(json, with("\"symmetry\"", "\"remark\": {\"unknown\": [1]}, \"symmetry\""));
    EXPECT_EQ(refusal(json), "") << "keys of later versions are passed over";
}

TEST_F(CoefficientFileAttack, SpectralAndDirectionFieldsAreChecked) {
    writeCoefficients(samples::make(OutgoingSet::direction(1, 2), Channels::spectral({400, 500}),
                                    Quantity::brdf, 2, 3),
                      json);
    const Json good = Json::parse(samples::contentOf(json));
    const struct {
        const char* pointer;
        Json value;
        const char* fragment;
    } cases[] = {
        {"/wavelengths_nm", {500, 400}, "ascending"},
        {"/wavelengths_nm", {400, 400}, "ascending"},
        {"/wavelengths_nm", {-1, 400}, "positive"},
        {"/wavelengths_nm", Json::array(), "positive"},
        {"/wavelengths_nm", {400, 500, 600}, "array of 3 names"},
        {"/wavelengths_nm", {400, "x"}, "array of numbers"},
        {"/outgoing/theta", 90, "less than 90"},
        {"/outgoing/theta", -1, "less than 90"},
        {"/outgoing/phi", 1e9, "from -360 to 360"},
        {"/outgoing/theta", 20, "unit vector of theta and phi"},
        {"/outgoing/direction", {0, 0}, "[x, y, z]"},
        {"/outgoing/direction", {0, 0, 0}, "unit vector"},
        {"/outgoing/direction", {0, 0, nullptr}, "array of numbers"},
    };
    for (const auto& [pointer, value, fragment] : cases) {
        SCOPED_TRACE(pointer);
        Json bad = good;
        bad[Json::json_pointer(pointer)] = value;
        expectJsonRefused(bad.dump(), fragment);
    }
    Json anglesOnly = good;
    anglesOnly["outgoing"].erase("direction");
    samples::put(json, anglesOnly.dump());
    EXPECT_NEAR(readCoefficients(json).outgoing.directions[0].z, std::cos(1.0), 1e-11);
}

// ---------------------------------------------------------------------------------------------
// EXR files that other programs could have written.

struct Plan {
    Imf::Header header;
    std::vector<std::string> channels;
};

/// The header and the channel names of a good file.
Plan planOf(const std::string& path) {
    writeCoefficients(sample(), path);
    Plan plan{Imf::Header(4, 5), {}};
    const std::string json = path + ".json";
    writeCoefficients(sample(), json);
    const Json metadata = Json::parse(samples::contentOf(json));
    for (const auto& [key, value] : metadata.items()) {
        if (key == "coefficients") continue;
        plan.header.insert(
            "hshfit:" + key,
            Imf::StringAttribute(value.is_string() ? value.get<std::string>() : value.dump()));
    }
    for (const char* slot : {"c000", "c001", "c002", "c003"}) {
        for (const char* colour : {".R", ".G", ".B"}) {
            plan.channels.push_back(std::string(slot) + colour);
            plan.header.channels().insert(plan.channels.back(), Imf::Channel(Imf::FLOAT));
        }
    }
    return plan;
}

/// `header` without one attribute; Header::erase leaks it.
Imf::Header without(const Imf::Header& header, const std::string& name) {
    Imf::Header result(4, 5);
    for (auto i = header.begin(); i != header.end(); ++i) {
        if (i.name() != name) result.insert(i.name(), i.attribute());
    }
    return result;
}

void save(const Imf::Header& header, const std::string& path, float value = 1, int rows = -1) {
    const auto& box = header.dataWindow();
    const int width = box.max.x - box.min.x + 1, height = box.max.y - box.min.y + 1;
    std::vector<float> pixels(static_cast<std::size_t>(width) * height, value);
    Imf::FrameBuffer buffer;
    // Slices start at pixel (0, 0), wherever the data window does.
    char* origin = reinterpret_cast<char*>(pixels.data()) -
                   4 * (box.min.x + static_cast<std::ptrdiff_t>(box.min.y) * width);
    const auto& list = header.channels();
    for (auto i = list.begin(); i != list.end(); ++i) {
        buffer.insert(i.name(), Imf::Slice(i.channel().type, origin, 4, 4ul * width));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(rows < 0 ? height : rows);
}

TEST_F(CoefficientFileAttack, AnExrOfAnotherProgramIsRead) {
    const Plan plan = planOf(exr);
    save(plan.header, exr, 0.5f);
    const Coefficients c = readCoefficients(exr);
    EXPECT_EQ(c.values, std::vector<double>(c.values.size(), 0.5));
    EXPECT_TRUE(looksLikeCoefficients(exr));
}

TEST_F(CoefficientFileAttack, ExrHeadersAreChecked) {
    const Plan plan = planOf(exr);
    const std::function<void(Imf::Header&)> none = [](Imf::Header&) {};
    const auto change = [&](const char* fragment, const std::function<void(Imf::Header&)>& edit,
                            float value = 1, int rows = -1) {
        SCOPED_TRACE(fragment);
        Imf::Header header = plan.header;
        edit(header);
        save(header, exr, value, rows);
        expectRefused(exr, fragment);
    };
    for (auto i = plan.header.begin(); i != plan.header.end(); ++i) {
        const std::string name = i.name();
        if (!name.starts_with("hshfit:")) continue;
        change(("'" + name.substr(7) + "' is missing").c_str(),
               [&](Imf::Header& h) { h = without(h, name); });
        change("has to be a string", [&](Imf::Header& h) {
            h = without(h, name);
            h.insert(name, Imf::IntAttribute(1));
        });
    }
    const auto attribute = [](const char* name, const std::string& text) {
        return [=](Imf::Header& h) { h.insert(name, Imf::StringAttribute(text)); };
    };
    change("'hshfit:basis' is not valid JSON", attribute("hshfit:basis", "{"));
    change("'hshfit:version' is not valid JSON", attribute("hshfit:version", "1,\"a\":2"));
    change("newer hshfit", attribute("hshfit:version", "7"));
    change("nested too deeply",
           attribute("hshfit:extra", std::string(100000, '[') + std::string(100000, ']')));
    change("is 4 x 5 pixels; its outgoing directions are 5 x 4",
           attribute("hshfit:outgoing",
                     "{\"map\":\"parabolic\",\"width\":5,\"height\":4,"
                     "\"inset_texels\":1,\"horizon_ring_degrees\":1}"));
    change("has 12 channels; order 3 and 3 colour channels need 27",
           attribute("hshfit:basis",
                     "{\"name\":\"hsh\",\"order\":3,\"condon_shortley\":false,"
                     "\"index\":\"l*(l+1)+m\"}"));
    const auto dropGreen = [&](Imf::Header& h) {
        h.channels() = Imf::ChannelList();
        for (const auto& name : plan.channels) {
            if (name != "c001.G") h.channels().insert(name, Imf::Channel(Imf::FLOAT));
        }
    };
    change("has 11 channels", [&](Imf::Header& h) { dropGreen(h); });
    change("has no channel 'c001.G'", [&](Imf::Header& h) {
        dropGreen(h);
        h.channels().insert("c001.Y", Imf::Channel(Imf::FLOAT));
    });
    change("channel 'c002.B' is not of type float",
           [](Imf::Header& h) { h.channels().insert("c002.B", Imf::Channel(Imf::HALF)); });
    change("channel 'c002.B' is not of type float",
           [](Imf::Header& h) { h.channels().insert("c002.B", Imf::Channel(Imf::UINT)); });
    change("compression", [](Imf::Header& h) { h.compression() = Imf::PIZ_COMPRESSION; });
    change("compression", [](Imf::Header& h) { h.compression() = Imf::DWAA_COMPRESSION; });
    change("start at (0, 0)", [](Imf::Header& h) {
        h.dataWindow() = Imath::Box2i(Imath::V2i(1, 1), Imath::V2i(4, 5));
    });
    change("is not finite at column 0, row 0", none, std::nanf(""));
    change("is not finite", none, std::numeric_limits<float>::infinity());
    change("invalid OpenEXR data", none, 1, 0);
}

// OpenEXR reads as many bytes as a type has and not as many as the file states, and then takes what
// follows for the next attribute, with a size of its own.
TEST_F(CoefficientFileAttack, ExrAttributesOfAnotherSizeAreRefused) {
    const Plan plan = planOf(exr);
    save(plan.header, exr);
    const std::string good = samples::contentOf(exr);
    const struct {
        const char *name, *type, *fragment;
    } cases[] = {{"displayWindow", "box2i", "'displayWindow' has 17 bytes; its type has 16"},
                 {"screenWindowWidth", "float", "'screenWindowWidth' has 5 bytes; its type has 4"},
                 {"channels", "chlist", "ends before its stated size"}};
    for (const auto& [name, type, fragment] : cases) {
        const std::string start = std::string(name) + '\0' + type + '\0';
        const auto at = good.find(start) + start.size();
        ASSERT_GT(at, start.size());
        std::int32_t size = 0;
        std::memcpy(&size, good.data() + at, 4);
        std::string bad = good;
        bad.insert(at + 4 + static_cast<std::size_t>(size), 1, '\0');
        ++size;
        std::memcpy(bad.data() + at, &size, 4);
        samples::put(exr, bad);
        expectRefused(exr, fragment);
    }
    Imf::Header header = plan.header;
    header.insert("remark", Imf::FloatVectorAttribute({1, 2}));
    save(header, exr);
    expectRefused(exr, "'remark' has a type that coefficient files do not use");
}

TEST_F(CoefficientFileAttack, OtherKindsOfExrAreRefused) {
    const Plan plan = planOf(exr);
    {
        Imf::Header header = plan.header;
        header.setTileDescription(Imf::TileDescription(4, 4));
        Imf::TiledOutputFile file(exr.c_str(), header);
    }
    expectRefused(exr, "tiled");
    {
        Imf::Header headers[2] = {plan.header, plan.header};
        for (auto& header : headers) header.setType("scanlineimage");
        headers[0].setName("a");
        headers[1].setName("b");
        Imf::MultiPartOutputFile file(exr.c_str(), headers, 2);
    }
    expectRefused(exr, "several parts");
}

TEST_F(CoefficientFileAttack, GiantSizesInExrHeadersAreRefused) {
    writeCoefficients(sample(), exr);
    const std::string good = samples::contentOf(exr);
    const auto patched = [&](const char* name, std::size_t field, std::int32_t value) {
        std::string bad = good;
        // name \0 type \0 size value…
        std::size_t at = bad.find(name) + std::strlen(name) + 1;
        at = bad.find('\0', at) + 1 + 4 * field;
        std::memcpy(bad.data() + at, &value, 4);
        samples::put(exr, bad);
    };
    const std::int32_t big = std::numeric_limits<std::int32_t>::max();
    patched("dataWindow", 3, big);
    expectRefused(exr, "at most 65536 pixels a side");
    patched("dataWindow", 3, -1);
    expectRefused(exr, "at most 65536 pixels a side");
    patched("dataWindow", 3, 65535);
    expectRefused(exr, "65536 x 5 pixels of 12 channels cannot come out of");
    patched("dataWindow", 4, 9);
    expectRefused(exr, "states 20 outgoing directions, but the file has 40");
    for (const char* name : {"channels", "hshfit:basis", "hshfit:source"}) {
        patched(name, 0, big);
        expectRefused(exr, "longer than the file");
        patched(name, 0, -1);
        expectRefused(exr, "longer than the file");
    }
}

}  // namespace
