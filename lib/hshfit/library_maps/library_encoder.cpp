#include <hshfit/library_maps/library_encoder.h>

#include <Imath/half.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace hshfit::inline library_maps {
namespace {

namespace ml = material_library;

float rounded(double value, gpu::Number number) {
    const auto single = static_cast<float>(value);
    return number == gpu::Number::float16 ? static_cast<float>(Imath::half(single)) : single;
}

void store(float value, gpu::Number number, std::byte* to) {
    if (number == gpu::Number::float32) {
        std::memcpy(to, &value, sizeof value);
    } else {
        const std::uint16_t bits = Imath::half(value).bits();
        std::memcpy(to, &bits, sizeof bits);
    }
}

}  // namespace

LibraryEncoder::LibraryEncoder(const ml::Basis& basis, std::size_t channels, gpu::Number number)
    : fit_(basis), layout_{channels, basis.size()}, number_(number) {}

std::size_t LibraryEncoder::linear() const {
    // As TexelLayout has them: in fours.
    return (layout_.channels * ml::fitPairs().size() + 3) / 4 * 4;
}

void LibraryEncoder::reduce(const float* texel, float* linear) const {
    std::copy_n(texel, this->linear(), linear);
}

std::vector<float> LibraryEncoder::numbersOf(const float* linear) const {
    std::vector<float> numbers(4 * layout_.layers());
    std::vector<double> channel(layout_.components + 1);
    double difference = 0, value = 0;
    for (std::size_t c = 0; c < layout_.channels; ++c) {
        const float* const f = linear + c * ml::fitPairs().size();
        fit_.fit(f, channel.data());
        for (double& number : channel) number = static_cast<double>(rounded(number, number_));
        const ml::PairFit::Squares squares = fit_.squares(f, channel.data());
        difference += squares.difference;
        value += squares.value;
        numbers[layout_.bound(c)] = static_cast<float>(channel[layout_.components]);
        numbers[layout_.factor(c, 0)] = 1;
        for (std::size_t k = 0; k < layout_.components; ++k)
            numbers[layout_.factor(c, k + 1)] = static_cast<float>(channel[k]);
    }
    numbers[layout_.error()] = relativeError(std::sqrt(difference), std::sqrt(value));
    return numbers;
}

EncodedRange LibraryEncoder::encode(std::size_t, std::span<const float> linear,
                                    const EncodedTexels& to) const {
    const std::size_t step = this->linear(), count = linear.size() / step,
                      bytes = gpu::numberBytes(number_);
    std::vector<EncodedRange> ranges(count);
    const auto one = [&](std::size_t t) {
        const std::vector<float> numbers = numbersOf(linear.data() + t * step);
        to.errors[t] = numbers[layout_.error()];
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            const float stored = rounded(static_cast<double>(numbers[k]), number_);
            ranges[t].finite = ranges[t].finite && std::isfinite(stored);
            ranges[t].largest = std::max(ranges[t].largest, std::abs(numbers[k]));
            store(stored, number_, to.bytes + k / 4 * to.pitch + (4 * t + k % 4) * bytes);
        }
    };
    // A thread that waits for others must not begin another tile, whose memory is the thread's.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, count, one); });
    EncodedRange all;
    for (const EncodedRange& range : ranges) {
        all.finite = all.finite && range.finite;
        all.largest = std::max(all.largest, range.largest);
    }
    return all;
}

}  // namespace hshfit::inline library_maps
