#include "option_words.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/gpu/containers/targets.h>

#include <utility>

namespace hshfit::jobs {

std::vector<Word> withAll(std::vector<Word> words) {
    words.push_back({"all", "every one of them"});
    return words;
}

std::vector<Word> basisWords() {
    return wordsOf(bases::catalog());
}

std::vector<Word> formWords() {
    return {{"outgoing"}, {"basis"}, {"halfway"}};
}

std::vector<Word> numberWords() {
    return {{"float16"}, {"float32"}, {"unorm16"}, {"unorm8"}};
}

std::vector<Word> precisionWords() {
    return {{"float64"}, {"float32"}, {"half"}, {"unorm16"}, {"unorm8"}};
}

std::vector<Word> splitWords() {
    return {{"diffuse", "the constant part"}};
}

std::vector<Word> storageWords() {
    return {{"auto"}, {"constants"}, {"block"}, {"texture"}};
}

std::vector<Word> targetWords() {
    return withAll(summariesOf(gpu::targets()));
}

std::vector<Word> windowWords() {
    return {{"none"}, {"hann"}, {"lanczos"}, {"bending"}};
}

}  // namespace hshfit::jobs
