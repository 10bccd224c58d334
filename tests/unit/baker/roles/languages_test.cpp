// SPDX-License-Identifier: GPL-3.0-or-later
// One human of 19 joints, named by many schemes and in many languages.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "baker/roles/names.h"
#include "role_cases.h"

using namespace spherechain::baker;

namespace {

// Names, separated by bars, of pelvis, spine, chest, neck, head, clavicle, upper arm, fore arm, hand, thigh, shin,
// foot. `sided` puts a side {1} to a name {0}.
struct Scheme {
  const char* names;
  const char *sided, *left, *right;
};

NamedRig human_of(const Scheme& scheme) {
  Names names{""};
  for (const char* c = scheme.names; *c != 0; ++c) {
    if (*c == '|')
      names.emplace_back();
    else
      names.back() += *c;
  }
  REQUIRE(names.size() == 12);
  const auto sided = [&](std::size_t i, bool left) {
    return fmt::format(fmt::runtime(scheme.sided), names[i], left ? scheme.left : scheme.right);
  };
  std::string tree;
  const auto add = [&](std::size_t depth, const std::string& name, const std::string& role) {
    tree += std::string(2 * depth, ' ') + name + " = " + role + "\n";
  };
  const Names middle{"pelvis", "spine", "chest", "neck", "head"};
  for (std::size_t i = 0; i < middle.size(); ++i) add(i, names[i], middle[i]);
  for (const bool left : {true, false}) {
    const std::string side = left ? "left_" : "right_";
    const Names arm{"clavicle", "shoulder", "elbow", "wrist"}, leg{"hip", "knee", "ankle"};
    for (std::size_t i = 0; i < arm.size(); ++i) add(3 + i, sided(5 + i, left), side + arm[i]);
  }
  for (const bool left : {true, false}) {
    const Names leg{"hip", "knee", "ankle"};
    for (std::size_t i = 0; i < leg.size(); ++i) add(1 + i, sided(9 + i, left), (left ? "left_" : "right_") + leg[i]);
  }
  return named_rig(tree);
}

constexpr const char* kGerman =
    "Hüfte|Wirbelsäule|Brust|Hals|Kopf|Schulter|Oberarm|Unterarm|Hand|Oberschenkel|Unterschenkel|Fuß";
constexpr const char* kFrench = "Bassin|Colonne|Poitrine|Cou|Tête|Épaule|Bras|AvantBras|Main|Cuisse|Mollet|Pied";
constexpr const char* kSpanish =
    "Cadera|Columna|Pecho|Cuello|Cabeza|Clavícula|Brazo|Antebrazo|Mano|Muslo|Pantorrilla|Pie";
constexpr const char* kItalian =
    "Bacino|Colonna|Petto|Collo|Testa|Spalla|Braccio|Avambraccio|Mano|Coscia|Polpaccio|Piede";
constexpr const char* kPortuguese = "Quadril|Coluna|Peito|Pescoço|Cabeça|Ombro|Braço|Antebraço|Mão|Coxa|Canela|Pé";
constexpr const char* kRussian = "Таз|Позвоночник|Грудь|Шея|Голова|Ключица|Плечо|Предплечье|Кисть|Бедро|Голень|Стопа";
constexpr const char* kPolish = "Miednica|Kręgosłup|Klatka|Szyja|Głowa|Bark|Ramię|Przedramię|Dłoń|Udo|Łydka|Stopa";
constexpr const char* kJapanese = "腰|背骨|胸|首|頭|鎖骨|上腕|前腕|手|太もも|すね|足";
constexpr const char* kChinese = "骨盆|脊椎|胸|脖子|头|锁骨|上臂|前臂|手|大腿|小腿|脚";
constexpr const char* kKorean = "골반|척추|가슴|목|머리|어깨|위팔|아래팔|손|허벅지|종아리|발";

constexpr Scheme kSchemes[]{
    // Tools and games.
    {"mixamorig:Hips|mixamorig:Spine|mixamorig:Spine2|mixamorig:Neck|mixamorig:Head|Shoulder|Arm|ForeArm|Hand|UpLeg|"
     "Leg|Foot",
     "mixamorig:{1}{0}", "Left", "Right"},
    {"pelvis|spine_01|spine_03|neck_01|head|clavicle|upperarm|lowerarm|hand|thigh|calf|foot", "{0}_{1}", "l", "r"},
    {"Hips|Spine|Chest|Neck|Head|Shoulder|UpperArm|LowerArm|Hand|UpperLeg|LowerLeg|Foot", "{1}{0}", "Left", "Right"},
    {"J_Bip_C_Hips|J_Bip_C_Spine|J_Bip_C_Chest|J_Bip_C_Neck|J_Bip_C_Head|Shoulder|UpperArm|LowerArm|Hand|UpperLeg|"
     "LowerLeg|Foot",
     "J_Bip_{1}_{0}", "L", "R"},
    {"Bip01 Pelvis|Bip01 Spine|Bip01 Spine1|Bip01 Neck|Bip01 Head|Clavicle|UpperArm|Forearm|Hand|Thigh|Calf|Foot",
     "Bip01 {1} {0}", "L", "R"},
    {"CATRigHub001|CATRigSpine1|CATRigHub002|CATRigNeck1|CATRigHub003|ArmCollarbone|Arm1|Arm2|ArmPalm|Leg1|Leg2|"
     "LegAnkle",
     "CATRig{1}{0}", "L", "R"},
    {"DEF-spine|DEF-spine.001|DEF-spine.003|DEF-spine.004|DEF-spine.006|shoulder|upper_arm|forearm|hand|thigh|shin|"
     "foot",
     "DEF-{0}.{1}", "L", "R"},
    {"hip|abdomenLower|chestUpper|neckLower|head|Collar|ShldrBend|ForearmBend|Hand|ThighBend|Shin|Foot", "{1}{0}", "l",
     "r"},
    {"root|spine05|spine01|neck01|head|clavicle|upperarm01|lowerarm01|wrist|upperleg01|lowerleg01|foot", "{0}.{1}", "L",
     "R"},
    {"Hips|LowerBack|Spine1|Neck|Head|Shoulder|Arm|ForeArm|Hand|UpLeg|Leg|Foot", "{1}{0}", "Left", "Right"},
    {"Pelvis|Spine1|Spine3|Neck|Head|Collar|Shoulder|Elbow|Wrist|Hip|Knee|Ankle", "{1}_{0}", "L", "R"},
    {"SpineBase|SpineMid|SpineShoulder|Neck|Head|Clavicle|Shoulder|Elbow|Wrist|Hip|Knee|Ankle", "{0}{1}", "Left",
     "Right"},
    {"下半身|上半身|上半身2|首|頭|肩|腕|ひじ|手首|足|ひざ|足首", "{1}{0}", "左", "右"},
    {"lower body|upper body|upper body2|neck|head|shoulder|arm|elbow|wrist|leg|knee|ankle", "{0}_{1}", "L", "R"},
    {"ValveBiped.Bip01_Pelvis|ValveBiped.Bip01_Spine|ValveBiped.Bip01_Spine2|ValveBiped.Bip01_Neck1|"
     "ValveBiped.Bip01_Head1|Clavicle|UpperArm|Forearm|Hand|Thigh|Calf|Foot",
     "ValveBiped.Bip01_{1}_{0}", "L", "R"},
    {"mPelvis|mTorso|mChest|mNeck|mHead|Collar|Shoulder|Elbow|Wrist|Hip|Knee|Ankle", "m{0}{1}", "Left", "Right"},

    // Languages.
    {kGerman, "{0}_{1}", "links", "rechts"},
    {kGerman, "{1}{0}", "Linker", "Rechter"},
    {kGerman, "{0}.{1}", "L", "R"},
    {kGerman, "{0}_{1}", "li", "re"},
    {"Becken|Wirbel|Brust|Hals|Kopf|Schluesselbein|Oberarm|Ellbogen|Handgelenk|Huefte|Knie|Knoechel", "{0}_{1}",
     "links", "rechts"},
    {"becken|bauch|brustkorb|nacken|kopf|schulter|oberarm|unterarm|hand|oberbein|unterbein|fuss", "{1}{0}", "linker",
     "rechter"},
    {kFrench, "{0}_{1}", "gauche", "droite"},
    {kFrench, "{0}_{1}", "G", "D"},
    {kFrench, "{0}{1}", "Gauche", "Droit"},
    {kFrench, "{1}_{0}", "g", "d"},
    {"hanches|dos|torse|nuque|tete|clavicule|bras superieur|bras inferieur|main|jambe superieure|jambe inferieure|pied",
     "{0} {1}", "gauche", "droit"},
    {kSpanish, "{0}_{1}", "izquierda", "derecha"},
    {kSpanish, "{0}.{1}", "i", "d"},
    {kSpanish, "{0}{1}", "Izq", "Der"},
    {"pelvis|espalda|torax|cuello|cabeza|hombro|brazo|codo|muneca|pierna|rodilla|tobillo", "{0}_{1}", "izquierdo",
     "derecho"},
    {kItalian, "{0}_{1}", "sinistra", "destra"},
    {kItalian, "{0}_{1}", "sx", "dx"},
    {kItalian, "{1}_{0}", "S", "D"},
    {"anche|schiena|torace|collo|testa|clavicola|spalla|gomito|polso|anca|ginocchio|caviglia", "{0}{1}", "Sinistro",
     "Destro"},
    {kPortuguese, "{0}_{1}", "esquerda", "direita"},
    {kPortuguese, "{0}_{1}", "e", "d"},
    {kPortuguese, "{1}{0}", "Esq", "Dir"},
    {"bacia|espinha|torax|pescoco|cabeca|clavicula|ombro|cotovelo|punho|perna|joelho|tornozelo", "{0} {1}", "esquerdo",
     "direito"},
    {kRussian, "{0}_{1}", "левая", "правая"},
    {kRussian, "{0}_{1}", "Л", "П"},
    {kRussian, "{1} {0}", "Лев", "Прав"},
    {"ТАЗ|СПИНА|ГРУДЬ|ШЕЯ|ГОЛОВА|ПЛЕЧО|РУКА|ЛОКОТЬ|КИСТЬ|НОГА|КОЛЕНО|СТУПНЯ", "{1}_{0}", "ЛЕВЫЙ", "ПРАВЫЙ"},
    {"taz|pozvonochnik|grud|sheya|golova|klyuchitsa|plecho|predplechye|kist|bedro|golen|stopa", "{0}_{1}", "lev",
     "prav"},
    {"taz|spina|grud|sheya|golova|plecho|ruka|lokot|ladon|noga|koleno|stupnya", "{1}_{0}", "levaya", "pravaya"},
    {"Таз|Живот|Грудь|Шея|Голова|Ключица|Плечо|Предплечье|Рука|Бедро|Голень|Нога", "{0}.{1}", "L", "R"},
    {kPolish, "{0}_{1}", "lewa", "prawa"},
    {kPolish, "{0}_{1}", "L", "P"},
    {kPolish, "{1}{0}", "Lewy", "Prawy"},
    {"biodra|plecy|piers|kark|glowa|obojczyk|ramie|lokiec|nadgarstek|biodro|kolano|kostka", "{1}_{0}", "lewe", "prawe"},
    {kJapanese, "{1}{0}", "左", "右"},
    {kJapanese, "{0}_{1}", "左", "右"},
    {kJapanese, "{0}.{1}", "L", "R"},
    {"こし|せぼね|むね|くび|あたま|かた|うで|ひじ|てくび|もも|ひざ|あしくび", "{1}{0}", "ひだり", "みぎ"},
    {"ヒップ|スパイン|チェスト|ネック|ヘッド|ショルダー|アーム|エルボー|ハンド|レッグ|ニー|フット", "{0}_{1}", "左",
     "右"},
    {"koshi|sebone|mune|kubi|atama|kata|ude|hiji|tekubi|momo|hiza|ashikubi", "{1}_{0}", "hidari", "migi"},
    {kChinese, "{1}{0}", "左", "右"},
    {kChinese, "{0}_{1}", "左", "右"},
    {"骨盆|脊椎|胸部|頸部|頭部|鎖骨|上臂|前臂|手掌|大腿|小腿|腳", "{1}{0}", "左", "右"},
    {"臀部|腰部|胸|颈|头|肩膀|大臂|小臂|手腕|大腿|膝盖|脚踝", "{1}_{0}", "左", "右"},
    {"pengu|jizhui|xiong|bozi|tou|suogu|shangbi|qianbi|shou|datui|xiaotui|jiao", "{1}_{0}", "zuo", "you"},
    {"gupen|yaobu|xiongbu|jingbu|toubu|jianbang|dabi|xiaobi|shouzhang|datui|xiaotui|jiaohuai", "{1}{0}", "zuo", "you"},
    {kKorean, "{1}{0}", "왼쪽", "오른쪽"},
    {kKorean, "{1} {0}", "왼", "오른"},
    {kKorean, "{0}_{1}", "좌", "우"},
    {"엉덩이|허리|흉부|목|머리|쇄골|상완|팔꿈치|손목|다리|무릎|발목", "{0}_{1}", "L", "R"}};

// Names as a Mac writes them: letters and marks apart.
std::string apart(std::string text) {
  for (const auto& [whole, parts] : {std::pair{"ü", "u\xCC\x88"},
                                     {"ä", "a\xCC\x88"},
                                     {"ê", "e\xCC\x82"},
                                     {"É", "E\xCC\x81"},
                                     {"ã", "a\xCC\x83"},
                                     {"ç", "c\xCC\xA7"},
                                     {"é", "e\xCC\x81"},
                                     {"í", "i\xCC\x81"},
                                     {"й", "и\xCC\x86"},
                                     {"じ", "し\xE3\x82\x99"},
                                     {"ざ", "さ\xE3\x82\x99"},
                                     {"발", "\xE1\x84\x87\xE1\x85\xA1\xE1\x86\xAF"}}) {
    for (std::size_t at = text.find(whole); at != std::string::npos; at = text.find(whole)) {
      text.replace(at, std::string(whole).size(), parts);
    }
  }
  return text;
}

NamedRig renamed(NamedRig rig, const auto& rename) {
  for (Node& node : rig.rig.nodes) node.name = rename(node.name);
  return rig;
}

}  // namespace

TEST_CASE("a human's joints are found by the names of every scheme and language, accents apart or not") {
  for (const Scheme& scheme : kSchemes) {
    CAPTURE(scheme.names);
    CAPTURE(scheme.sided);
    CAPTURE(scheme.left);
    const NamedRig rig = human_of(scheme);
    check_roles(rig);
    check_roles(renamed(rig, apart));
  }
}

TEST_CASE("one rig may be named in several languages, and letters that count tell no sides") {
  NamedRig mixed = human_of(kSchemes[2]);
  const NamedRig german = human_of(kSchemes[16]), chinese = human_of({kChinese, "{1}{0}", "左", "右"});
  for (std::size_t n = 0; n < mixed.rig.nodes.size(); ++n) {
    if (n % 3 == 1) mixed.rig.nodes[n].name = german.rig.nodes[n].name;
    if (n % 3 == 2) mixed.rig.nodes[n].name = chinese.rig.nodes[n].name;
  }
  check_roles(mixed);
  const std::vector<Hint> counted = read_names({"hand_c", "hand_d", "hand_e", "bras_g", "bras_d", "mano_d", "p_leg"});
  for (const std::size_t n : {0U, 1U, 2U, 5U, 6U}) CHECK(counted[n].side == NamedSide::kNone);
  CHECK(counted[3].side == NamedSide::kLeft);
  CHECK(counted[4].side == NamedSide::kRight);
  CHECK(read_names({"main", "\xFF\xFE\xC3", ""})[0].word == Word::kNone);
}

TEST_CASE("a few known names among numbers are no worse than none: the shape says what they leave out") {
  const NamedRig rig = human_of(kSchemes[2]);
  const std::vector<Names> known{{"LeftHand", "RightHand"},
                                 {"LeftHand", "RightHand", "LeftFoot", "RightFoot"},
                                 {"LeftUpperArm", "LeftLowerArm", "LeftHand"},
                                 {"LeftUpperArm", "RightUpperArm", "LeftUpperLeg", "RightUpperLeg"},
                                 {"Head", "LeftLowerArm"},
                                 {"RightLowerLeg"}};
  for (const Names& names : known) {
    int number = 0;
    const NamedRig numbered = renamed(rig, [&](const std::string& name) {
      const std::string numbered_name = "joint" + std::to_string(number++);
      return std::find(names.begin(), names.end(), name) == names.end() ? numbered_name : name;
    });
    CAPTURE(names.front());
    const Roles roles = roles_of(numbered);
    CHECK(roles.kind == BodyKind::kBiped);
    for (std::size_t n = 0; n < rig.expected.size(); ++n) {
      CAPTURE(rig.rig.nodes[n].name);
      CHECK(roles.of_node[n].role == rig.expected[n]);
    }
  }
}
