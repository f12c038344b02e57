/// What is proposed where a field is not known, after it was tried.
#include "refuse.h"
#include "yaml_fields.h"

namespace pf::sequence {

Fields Fields::edited(const std::vector<std::string>& above, const std::string& key, const std::string& name) const {
  YAML::Node copy(YAML::NodeType::Map);
  for (const auto& entry : node_) {
    const std::string found = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
    if (above.empty() && found == key) {
      if (!name.empty()) {
        copy.force_insert(name, entry.second);
      }
    } else if (!above.empty() && found == above.front() && entry.second.IsMap()) {
      const Fields inner(entry.second, file_, {});
      copy.force_insert(found, inner.edited({above.begin() + 1, above.end()}, key, name).node_);
    } else {
      copy.force_insert(entry.first, entry.second);
    }
  }
  return Fields(copy, file_, above_);
}

namespace {

/// Whether the fields can be read, as they are or with other fields that are not known renamed or left out.
bool would_be_read(const Fields& fields, const std::function<void(const Fields&)>& read, int edits) {
  try {
    read(fields);
    return true;
  } catch (const UnknownField& unknown) {
    return edits > 0 &&
           ((!unknown.nearest().empty() &&
             would_be_read(fields.edited(unknown.above(), unknown.key(), unknown.nearest()), read, edits - 1)) ||
            would_be_read(fields.edited(unknown.above(), unknown.key(), ""), read, edits - 1));
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

void read_with_hints(const Fields& fields, const std::function<void(const Fields&)>& read) {
  constexpr int kMaxEdits = 4;
  try {
    read(fields);
  } catch (const UnknownField& unknown) {
    const std::string line = unknown.what();
    if (!unknown.nearest().empty() &&
        would_be_read(fields.edited(unknown.above(), unknown.key(), unknown.nearest()), read, kMaxEdits)) {
      refuse(line + "; is '" + unknown.nearest() + "' meant?");
    }
    if (would_be_read(fields.edited(unknown.above(), unknown.key(), ""), read, kMaxEdits)) {
      refuse(line + "; remove it only if it says nothing of the lens or the size of these images");
    }
    refuse(line);
  }
}

}  // namespace pf::sequence
