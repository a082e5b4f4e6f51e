#pragma once

#include <brdfs/measured/bsdf_xml/document.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// A cursor in the text of a ScatteringData: numbers with blanks, line ends and at most one
/// comma between them, and braces.
class DataCursor {
public:
    DataCursor(const BsdfDocument& document, const BsdfBlock& block)
        : document_(document), block_(block), rest_(block.data) {}

    /// The character that comes next, behind blanks; 0 at the end.
    char next();
    /// The text that comes next, for messages.
    std::string found();
    void skip() { rest_.remove_prefix(1); }
    void skipComma() {
        if (next() == ',') skip();
    }
    /// Takes a number and the comma behind it; false at a brace or the end. NaN and infinity are
    /// accepted, and the offset of the first is kept. Throws InputError for words and for finite
    /// numbers beyond 1e30, which no BSDF reaches and sums of which could overflow.
    bool take(double& value);

    std::size_t offset() const { return block_.dataOffset + (block_.data.size() - rest_.size()); }
    /// Offset in the file of the first value that was NaN or infinite; 0: none.
    std::size_t corruptOffset() const { return corruptOffset_; }
    InputError error(std::string_view message) const { return document_.error(offset(), message); }
    InputError errorAt(std::size_t offset, std::string_view message) const {
        return document_.error(offset, message);
    }

private:
    const BsdfDocument& document_;
    const BsdfBlock& block_;
    std::string_view rest_;
    std::size_t corruptOffset_ = 0;
};

}  // namespace hshfit::brdfs
