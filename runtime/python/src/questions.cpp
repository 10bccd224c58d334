// SPDX-License-Identifier: MIT
// The questions of a body, about each pose of a batch.
#include <array>

#include "binding.h"
#include "model.h"
#include "parallel.h"

namespace spherechain::python {
namespace {

enum class Question { kPenetrations, kContacts, kSteps, kGround, kBounds };

// One of the bodies that are asked about, and of steps where it comes from.
struct Side {
  const LoadedModel* model = nullptr;
  SkinPoses before, now;
};

struct Asked {
  Question question;
  Query query;
  Ground ground;
  Side sides[2];  // the second without a model: each pose with itself
};

// Entries as bytes: penetrations, steps, or the corners of a box; of contacts body parts, spheres and triangles.
struct Answer {
  std::string lists[3];
  std::size_t total = 0;  // how many there are, where a limit lists fewer

  template <typename T>
  void put(std::size_t list, const T* entries, std::size_t count) {
    lists[list].assign(reinterpret_cast<const char*>(entries), count * sizeof(T));
  }
};

// The bodies of one thread.
class Asker {
 public:
  explicit Asker(const Asked& asked) : asked_(asked) {
    bodies_[0] = take(0, 0);
    if (asked.sides[1].model != nullptr) {
      bodies_[1] = take(1, 0);
    }
  }
  Asker(Asker&&) = default;
  ~Asker() {
    const bool is_kept = &other_of(0) == asked_.sides[0].model && asked_.question != Question::kSteps;
    for (Body& body : bodies_) {
      if (body && is_kept) {
        asked_.sides[0].model->give_back(std::move(body));
      }
    }
  }

  void ask(std::size_t i, Answer& out) {
    set_poses(i);
    sc_body *const body = bodies_[0].handle(), *const other = bodies_[1].handle();
    const Query& query = asked_.query;
    sc_penetrations found{};
    if (asked_.question == Question::kContacts) {
      const sc_contacts contacts = find_contacts(i, query);
      out.put(0, contacts.parts, contacts.part_count);
      out.put(1, contacts.spheres, contacts.sphere_count);
      out.put(2, contacts.triangles, contacts.triangle_count);
    } else if (asked_.question == Question::kSteps) {
      const sc_step_contact* steps = nullptr;
      std::size_t count = 0;
      require(sc_find_steps(body, other, &query, &steps, &count));
      out.put(0, steps, count);
    } else if (asked_.question == Question::kBounds) {
      Vec3 corners[2];
      require(sc_get_bounds(body, &corners[0], &corners[1]));
      out.put(0, corners, 2);
    } else if (asked_.question == Question::kGround) {
      require(sc_find_in_ground(body, &asked_.ground, &query, &found));
    } else {
      Query all = query;
      all.full = 1;
      find_contacts(i, all);  // two parts that have more triangles than a body has room for are measured whole
      require(sc_find_penetrations(bodies_[0].handle(), other, &query, &found));
    }
    if (asked_.question == Question::kGround || asked_.question == Question::kPenetrations) {
      out.put(0, found.items, found.count);
      out.total = found.total;
    }
  }

 private:
  const LoadedModel& other_of(std::size_t side) const {
    const Side& other = asked_.sides[1 - side];
    return *(other.model == nullptr ? asked_.sides[side] : other).model;
  }

  Body take(std::size_t side, std::size_t max_triangles) const {
    return asked_.sides[side].model->take_body(other_of(side), asked_.question == Question::kSteps, max_triangles);
  }

  void set_poses(std::size_t i) {
    for (std::size_t k = 0; k < 2 && bodies_[k]; ++k) {
      const Side& side = asked_.sides[k];
      for (const SkinPoses* poses : {&side.before, &side.now}) {
        if (i >= poses->count) {
          continue;
        }
        require(bodies_[k].set_pose(pose_of(*side.model, *poses, i)));
      }
    }
  }

  // With a larger body where one has no room for all triangles.
  sc_contacts find_contacts(std::size_t i, const Query& query) {
    sc_contacts found{};
    require(sc_find_contacts(bodies_[0].handle(), bodies_[1].handle(), &query, &found));
    if (found.triangle_count < found.triangle_total) {
      bodies_[0] = take(0, 2 * found.triangle_total);
      set_poses(i);
      require(sc_find_contacts(bodies_[0].handle(), bodies_[1].handle(), &query, &found));
    }
    return found;
  }

  const Asked& asked_;
  Body bodies_[2];
};

// `query` has the fields of an sc_query by their names. Both sides are (poses before or None, poses).
Object ask(const LoadedModel& model, int question, const std::array<Object, 2>& poses, const LoadedModel* other,
           const std::array<Object, 2>& others, const Object& query, std::size_t threads) {
  Asked asked{static_cast<Question>(question), {}, {}, {}};
  const LoadedModel& second = other == nullptr ? model : *other;
  asked.sides[0] = {&model, skin_poses_of(model, poses[0].get()), skin_poses_of(model, poses[1].get())};
  asked.sides[1] = {other, skin_poses_of(second, others[0].get()), skin_poses_of(second, others[1].get())};
  const std::size_t count = asked.sides[0].now.count;
  for (const Side& side : asked.sides) {
    require(side.model == nullptr || side.now.count == count, "others");
    require(side.before.count == 0 || side.before.count == count, "before");
  }

  const std::size_t parts = model.info().part_count, of_other = second.info().part_count;
  const auto words = [&](const char* name, std::size_t bits) -> const std::uint64_t* {
    const auto given = entry<std::optional<Array<std::uint64_t>>>(query, name);
    return given ? checked(*given, {(bits + 63) / 64}, name) : nullptr;
  };
  Query& q = asked.query;
  q.scope = entry<Scope>(query, "scope");
  q.full = entry<bool>(query, "full") ? 1 : 0;
  q.classes = entry<std::uint32_t>(query, "classes");
  q.limit = entry<std::size_t>(query, "limit");
  q.tolerance = entry<float>(query, "tolerance");
  q.ignored_parts = words("ignored_parts", parts);
  q.ignored_parts_of_other = words("ignored_parts_of_other", of_other);
  q.part_pairs = words("part_pairs", parts * of_other);
  const auto previous = entry<std::optional<Array<std::uint8_t>>>(query, "previous");
  if (previous) {
    q.previous_count = length(*previous) / sizeof(Penetration);
    q.previous =
        reinterpret_cast<Penetration*>(checked(*previous, {q.previous_count * sizeof(Penetration)}, "previous"));
  }
  const AssetInfo info = sc_asset_get_info(&model.asset());
  std::vector<std::uint64_t> ignored(info.ignored_pairs, info.ignored_pairs + sc_pair_words(&model.asset()));
  if (const auto given =
          entry<std::optional<std::vector<std::pair<std::uint32_t, std::uint32_t>>>>(query, "ignored_spheres")) {
    for (const auto& [a, b] : *given) {
      const std::size_t low = std::min(a, b), high = std::max(a, b), bit = high * (high - 1) / 2 + low;
      require(low != high && high < info.sphere_count ? Status{} : Status{SC_BAD_VALUE, SC_FIELD_INDEX});
      ignored[bit / 64] |= std::uint64_t{1} << bit % 64;
    }
    q.ignored_pairs = ignored.data();
  }
  const Rule rule = rule_of(entry<std::vector<float>>(query, "rule"));
  q.rule = &rule;
  const auto [x, y, z, height] = entry<std::array<float, 4>>(query, "ground");
  asked.ground.up = {x, y, z};
  asked.ground.height = height;

  std::vector<Answer> found(count);
  for_each_pose(count, threads,
                [&] { return [&found, asker = Asker(asked)](std::size_t i) mutable { asker.ask(i, found[i]); }; });
  return list_of(count, [&](std::size_t i) {
    const Answer& of = found[i];
    return tuple_of(Bytes{of.lists[0]}, Bytes{of.lists[1]}, Bytes{of.lists[2]}, of.total);
  });
}

// Throws with the message of sc_check_rest() for the first pose that is no rest pose.
void check_rest(const LoadedModel& model, const Array<float>& bones) {
  const Poses<float> poses = poses_of(model.joint_count(), bones);
  for (std::size_t i = 0; i < poses.count; ++i) {
    const Pose pose = pose_of(poses, model.joint_count(), i);
    char message[512] = "";
    if (sc_check_rest(model.model().handle(), &pose, message, sizeof message) != SC_OK) {
      throw std::invalid_argument(message);
    }
  }
}

// A static method of the class Model.
PyObject* get_default_rule(PyObject*, PyObject*) {
  return guarded([] {
    const std::vector<float> rule = default_rule();
    return list_of(rule.size(), [&](std::size_t i) { return to_python(rule[i]); }).release();
  });
}

}  // namespace

const std::vector<PyMethodDef> question_methods{{"default_rule", &get_default_rule, METH_NOARGS | METH_STATIC, nullptr},
                                                {"ask", Call<&ask>::run, METH_VARARGS, nullptr},
                                                {"check_rest", Call<&check_rest>::run, METH_VARARGS, nullptr}};

}  // namespace spherechain::python
