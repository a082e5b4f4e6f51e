#include <hshfit/material_library/material_store.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <span>
#include <string_view>

namespace hshfit::material_library {
namespace {

/// Numbers and lists of numbers one after another, as they are in memory.
class RecordWriter {
public:
    template <class Number>
    void number(const Number& value) {
        text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <class List>
    void list(const List& values) {
        number(values.size());
        text_.append(reinterpret_cast<const char*>(values.data()),
                     values.size() * sizeof values[0]);
    }
    std::string take() { return std::move(text_); }

private:
    std::string text_;
};

class RecordReader {
public:
    explicit RecordReader(std::string_view text) : text_(text) {}

    template <class Number>
    void number(Number& value) {
        std::memcpy(&value, taken(sizeof value), sizeof value);
    }
    template <class List>
    void list(List& values) {
        std::size_t count = 0;
        number(count);
        values.resize(count);
        const std::size_t bytes = count * sizeof values[0];
        if (bytes > 0) std::memcpy(values.data(), taken(bytes), bytes);
    }

private:
    const char* taken(std::size_t bytes) {
        assert(at_ + bytes <= text_.size());
        at_ += bytes;
        return text_.data() + at_ - bytes;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

}  // namespace

void MaterialStore::add(std::vector<Place>& places, Place place, const std::string& record) {
    const std::lock_guard one(adding_);
    place.bytes = static_cast<std::uint32_t>(record.size());
    place.offset = file_.append(record);
    places.push_back(std::move(place));
}

void MaterialStore::add(const Measured& measured) {
    RecordWriter record;
    record.list(measured.source);
    record.number(measured.error);
    record.list(measured.exponents);
    record.list(measured.tops);
    record.list(measured.rest);
    add(measured_,
        {.name = measured.name, .channels = static_cast<std::uint32_t>(measured.channels())},
        record.take());
}

void MaterialStore::add(const Material& own) {
    assert(own.kind == Kind::halfway);
    RecordWriter record;
    record.list(own.source);
    record.list(own.halfway);
    record.number(own.bytes);
    record.list(own.fallback);
    record.number(own.error);
    add(own_, {.name = own.name, .channels = static_cast<std::uint32_t>(own.channels)},
        record.take());
}

std::string MaterialStore::recordOf(const Place& place) const {
    std::string record(place.bytes, '\0');
    file_.read(place.offset, std::as_writable_bytes(std::span(record.data(), record.size())));
    return record;
}

Measured MaterialStore::measured(std::size_t number) const {
    const Place& place = measured_[number];
    const std::string text = recordOf(place);
    RecordReader record(text);
    Measured measured{.name = place.name, .source = {}, .exponents = {}, .tops = {}};
    record.list(measured.source);
    record.number(measured.error);
    record.list(measured.exponents);
    record.list(measured.tops);
    record.list(measured.rest);
    return measured;
}

Material MaterialStore::own(std::size_t number) const {
    const Place& place = own_[number];
    const std::string text = recordOf(place);
    RecordReader record(text);
    Material own{
        .name = place.name, .source = {}, .kind = Kind::halfway, .channels = place.channels};
    record.list(own.source);
    record.list(own.halfway);
    record.number(own.bytes);
    record.list(own.fallback);
    record.number(own.error);
    return own;
}

void MaterialStore::sort() {
    std::ranges::sort(measured_, {}, &Place::name);
    std::ranges::sort(own_, {}, &Place::name);
    const auto refuse = [](const std::string& name, const std::string& a, const std::string& b) {
        throw UsageError(
            fmt::format("two materials are named '{}' ({} and {}): give one of them "
                        "another name",
                        name, std::min(a, b), std::max(a, b)));
    };
    const auto twice = [](const std::vector<Place>& places) {
        return static_cast<std::size_t>(std::ranges::adjacent_find(places, {}, &Place::name) -
                                        places.begin());
    };
    if (const std::size_t k = twice(measured_); k < measured_.size())
        refuse(measured_[k].name, measured(k).source, measured(k + 1).source);
    if (const std::size_t k = twice(own_); k < own_.size())
        refuse(own_[k].name, own(k).source, own(k + 1).source);
    for (std::size_t k = 0; k < own_.size(); ++k) {
        const auto same = std::ranges::lower_bound(measured_, own_[k].name, {}, &Place::name);
        if (same == measured_.end() || same->name != own_[k].name) continue;
        refuse(own_[k].name, own(k).source,
               measured(static_cast<std::size_t>(same - measured_.begin())).source);
    }
}

}  // namespace hshfit::material_library
