#include <hshfit/representation/named_arrays.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

namespace hshfit::inline representation {
namespace {

using Kind = Representation::Kind;

/// The names of all members, once for both directions. `visit(name, array)` is called for each.
struct Members {
    template <class Part, class Visit>
    static void ofPart(Part& part, const std::string& block, Visit visit) {
        if constexpr (requires { part.terms; }) visit("block " + block, part.terms);
        if constexpr (requires { part.left; }) visit("left " + block, part.left);
        if constexpr (requires { part.core; }) visit("core " + block, part.core);
        if constexpr (requires { part.right; }) visit("right " + block, part.right);
    }
    template <class Each, class Visit>
    static void of(Each& content, Visit visit) {
        if constexpr (requires { content.coefficients; })
            visit("coefficients", content.coefficients);
        if constexpr (requires { content.left; }) visit("left", content.left);
        if constexpr (requires { content.right; }) visit("right", content.right);
        if constexpr (requires { content.matrix; }) visit("matrix", content.matrix);
        if constexpr (requires { content.halfway; }) visit("halfway", content.halfway);
        if constexpr (requires { content.blocks; }) {
            for (auto& block : content.blocks) {
                std::visit([&](auto& part) { ofPart(part, block.name, visit); }, block.part);
            }
        }
    }
};

template <class Array, class R>
std::vector<Named<Array*>> listed(R& representation) {
    std::vector<Named<Array*>> list;
    const auto add = [&](std::string name, Array& array) {
        list.push_back({std::move(name), &array});
    };
    std::visit([&](auto& each) { Members::of(each, add); }, representation.content);
    return list;
}

/// Arrays by name, each taken once.
class Pile {
public:
    explicit Pile(std::vector<Named<StoredArray>> arrays) : arrays_(std::move(arrays)) {}

    bool has(std::string_view name) const { return find(name) != arrays_.end(); }
    bool empty() const { return arrays_.empty(); }
    const std::string& first() const { return arrays_.front().name; }
    StoredArray take(std::string_view name) {
        const auto found = find(name);
        if (found == arrays_.end()) throw InputError(fmt::format("has no array '{}'", name));
        StoredArray array = std::move(found->array);
        arrays_.erase(found);
        return array;
    }
    /// Fills members of one content or block, all of which have to be there.
    template <class Each>
    Each fill() {
        Each content;
        Members::of(content, [&](const std::string& name, StoredArray& a) { a = take(name); });
        return content;
    }
    template <class Part>
    MatrixBlock fillBlock(const std::string& block) {
        Part part;
        Members::ofPart(part, block,
                        [&](const std::string& name, StoredArray& a) { a = take(name); });
        return {block, std::move(part)};
    }

private:
    std::vector<Named<StoredArray>>::const_iterator find(std::string_view name) const {
        return std::ranges::find(arrays_, name, &Named<StoredArray>::name);
    }
    std::vector<Named<StoredArray>>::iterator find(std::string_view name) {
        return std::ranges::find(arrays_, name, &Named<StoredArray>::name);
    }

    std::vector<Named<StoredArray>> arrays_;
};

/// The block that an array of this name belongs to; none if it names no part of a block.
std::optional<std::string> blockOf(const std::string& name) {
    for (const std::string_view part : {"block ", "left ", "core ", "right "}) {
        if (name.starts_with(part)) return name.substr(part.size());
    }
    return std::nullopt;
}

MatrixFactors blocksOf(Pile& pile) {
    MatrixFactors factors;
    while (!pile.empty()) {
        const std::optional<std::string> block = blockOf(pile.first());
        if (!block) break;
        factors.blocks.push_back(pile.has("block " + *block) ? pile.fillBlock<WholeBlock>(*block)
                                 : pile.has("core " + *block)
                                     ? pile.fillBlock<SymmetricBlock>(*block)
                                     : pile.fillBlock<ProductBlock>(*block));
    }
    return factors;
}

Content contentOf(Kind kind, Pile& pile) {
    switch (kind) {
        case Kind::outgoing:
            if (pile.has("left")) return pile.fill<CoefficientFactors>();
            return pile.fill<CoefficientArray>();
        case Kind::basis:
            if (pile.has("matrix")) return pile.fill<MatrixArray>();
            if (pile.empty()) throw InputError("has no array 'matrix' and no factors of blocks");
            return blocksOf(pile);
        case Kind::halfway:
            break;
    }
    return pile.fill<HalfwayArray>();
}

std::string_view namesOf(Kind kind) {
    switch (kind) {
        case Kind::outgoing:
            return "'coefficients', or 'left' and 'right'";
        case Kind::basis:
            return "'matrix', or factors of blocks, each 'block NAME', or 'left NAME' or "
                   "'core NAME' and 'right NAME'";
        case Kind::halfway:
            break;
    }
    return "'halfway'";
}

}  // namespace

std::vector<Named<StoredArray*>> namedArrays(Representation& representation) {
    return listed<StoredArray>(representation);
}

std::vector<Named<const StoredArray*>> namedArrays(const Representation& representation) {
    return listed<const StoredArray>(representation);
}

Content contentOf(Kind kind, std::vector<Named<StoredArray>> arrays) {
    Pile pile(std::move(arrays));
    Content content = contentOf(kind, pile);
    if (pile.empty()) return content;
    throw InputError(fmt::format("'{}' is one array too many; the form {} has {}, each once",
                                 pile.first().substr(0, 40), kindName(kind), namesOf(kind)));
}

}  // namespace hshfit::inline representation
