// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/words.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "baker/roles/letters.h"

namespace spherechain::baker {
namespace {

// Words as rigs write them, and the thing they mean where people name it by itself: English; German, French, Spanish,
// Italian, Portuguese, Polish; Russian, in its own letters and in Latin ones; Japanese (MikuMikuDance's names among
// them), Chinese, simplified and traditional, and its pinyin; Korean.
struct Line {
  Word word;
  const char* words;
  std::string_view thing{};
};
constexpr Line kLines[]{
    {Word::kRoot,
     "root armature reference cog center groove parentnode wurzel racine raiz radice korzen корень koren "
     "センター グルーブ 全ての親 ルート 根 根骨 根骨骼 루트"},
    {Word::kPelvis,
     "hips pelvis lowerbody becken unterkorper unterkoerper bassin bacino fianchi bacia miednica таз taz 下半身 骨盤 "
     "腰 こし "
     "ヒップ koshi kahanshin 骨盆 盆骨 臀 臀部 胯 gupen pengu tunbu 골반 엉덩이 하체 하반신"},
    {Word::kSpine,
     "spine torso abdomen ab waist back lowerback belly stomach body upperbody spinal trunk "
     "wirbel wirbelsaule wirbelsaeule rucken ruecken ruckgrat rueckgrat bauch rumpf taille oberkorper "
     "oberkoerper colonne colonnevertebrale vertebre dos ventre torse echine columna columnavertebral "
     "espalda espina vientre cintura tronco vertebra colonna colonnavertebrale schiena spina addome vita "
     "busto coluna colunavertebral espinha costas abdome barriga kregoslup plecy brzuch tulow talia "
     "позвоночник спина живот поясница торс туловище тело pozvonochnik zhivot poyasnitsa tors tulovische "
     "上半身 背骨 脊椎 背中 腹 腹部 胴 胴体 せぼね せなか はら スパイン sebone senaka jouhanshin joohanshin "
     "johanshin 脊柱 脊骨 脊 躯干 軀幹 背 背部 腰部 腰椎 上身 jizhui yaobu fubu 척추 허리 등 배 몸통 상체 상반신"},
    {Word::kChest,
     "chest upperchest thorax ribcage ribs brust brustkorb brustbein poitrine pecho torax petto torace "
     "peito klatka klatkapiersiowa piers грудь груднаяклетка грудная grud 胸 胸部 むね チェスト mune 胸腔 "
     "胸椎 xiong xiongbu 가슴 흉부 흉곽"},
    {Word::kNeck,
     "neck hals nacken genick cou nuque cuello nuca collo pescoco szyja kark шея sheya sheia sheja 首 "
     "くび ネック kubi 脖子 脖 颈 頸 颈部 頸部 颈椎 頸椎 bozi jingbu 목"},
    {Word::kHead,
     "head skull kopf schadel schaedel tete crane cabeza craneo testa cranio cabeca glowa czaszka "
     "голова череп golova cherep 頭 頭部 あたま ヘッド atama 头 头部 头骨 頭骨 tou toubu 머리 두부"},

    {Word::kClavicle,
     "clavicle collar collarbone scapula shoulderblade clav schlusselbein schluesselbein "
     "schulterblatt clavicule omoplate clavicula claviculas escapula clavicola scapola omoplata "
     "obojczyk lopatka ключица лопатка klyuchitsa klyuchica kluchica kljuchica lopatka 鎖骨 さこつ "
     "sakotsu 锁骨 suogu 쇄골"},
    {Word::kShoulder,
     "shoulder shldr schulter epaule hombro spalla ombro bark плечо plecho 肩 かた ショルダー 肩膀 肩部 "
     "jianbu jianbang 어깨"},
    {Word::kArm, "wing wings 翼 날개", "wing"},
    {Word::kArm, "arm bras brazo braccio braco ramie рука ruka 腕 うで アーム 手臂 臂 胳膊 shoubi gebo 팔"},
    {Word::kUpperArm,
     "upperarm uparm armupper bicep biceps humerus oberarm hautbras hautdubras avantbrashaut "
     "bicipite плечеваякость верхруки verhruki 上腕 二の腕 じょうわん 上臂 大臂 shangbi dabi 위팔 윗팔 "
     "상완 상박"},
    {Word::kForeArm,
     "forearm lowerarm lowarm loarm armlower elbow ulna foretwist unterarm vorderarm ellbogen "
     "ellenbogen avantbras coude antebrazo codo avambraccio gomito antebraco cotovelo przedramie "
     "lokiec предплечье локоть predplechye predpleche predplechie predpleczie predplechje lokot "
     "前腕 下腕 肘 ひじ エルボー 手捩 手捩り 手捻 hiji 前臂 小臂 下臂 手肘 肘部 qianbi xiaobi zhoubu "
     "아래팔 아랫팔 팔뚝 전완 하박 팔꿈치"},
    {Word::kHand,
     "hand wrist palm handgelenk handflache handflaeche poignet paume mano muneca palma polso mao pulso "
     "punho dlon reka nadgarstek кисть ладонь запястье kist ladon zapyaste zapyastye 手首 手 手のひら てくび "
     "て ハンド リスト tekubi 手掌 手部 手腕 腕部 shou shouzhang shouwan 손 손목 손바닥"},
    {Word::kFinger,
     "finger fingers thumb index middle ring pinky pinkie little metacarpal carpal knuckle daumen "
     "zeigefinger mittelfinger ringfinger doigt doigts pouce majeur annulaire auriculaire dedo dedos "
     "pulgar indice anular menique dito dita pollice anulare mignolo polegar indicador anelar palec "
     "palce kciuk палец пальцы palets paltsy 指 ゆび 親指 人指 人差指 中指 薬指 小指 yubi oyayubi "
     "hitosashi nakayubi kusuriyubi koyubi 手指 拇指 大拇指 食指 无名指 無名指 尾指 shouzhi 손가락 엄지 "
     "검지 중지 약지 새끼"},

    {Word::kHip,
     "hip hufte huefte huft hanche hanches cadera caderas anca anche quadril quadris biodro biodra бедра "
     "髋 髖 髋部 髖部 kuan kuanbu 股関節 고관절 hipjoint"},
    {Word::kLeg,
     "leg foreleg hindleg bein jambe pierna gamba perna noga нога 足 脚 腳 腿 あし レッグ 腿部 tui tuibu "
     "다리"},
    {Word::kThigh,
     "thigh upperleg upleg legupper femur oberschenkel oberbein schenkel cuisse hautjambe muslo coscia "
     "coxa udo бедро bedro верхноги 太もも 太腿 大腿 大腿部 もも ふともも momo futomomo datui 허벅지 넓적다리 "
     "대퇴 윗다리 위다리"},
    {Word::kShin,
     "shin calf knee lowerleg lowleg loleg leglower tibia unterschenkel unterbein knie schienbein wade "
     "genou mollet bassejambe basjambe rodilla espinilla pantorrilla canilla ginocchio polpaccio stinco "
     "joelho canela panturrilha kolano lydka golen podudzie piszczel голень колено икра koleno ikra "
     "膝 ひざ 脛 すね 下腿 ふくらはぎ ニー hiza sune 小腿 小腿部 膝盖 膝蓋 膝关节 xiaotui xigai 종아리 정강이 "
     "아랫다리 아래다리 하퇴 무릎"},
    {Word::kFoot,
     "foot ankle paw hoof fuss knochel knoechel sprunggelenk pied cheville tobillo piede caviglia "
     "tornozelo stopa kostka стопа ступня лодыжка щиколотка stupnya lodyzhka 足首 あしくび フット アンクル "
     "ashikubi 足部 脚踝 腳踝 脚腕 腳腕 足踝 踝 脚掌 腳掌 脚部 jiao jiaobu jiaohuai 발 발목"},
    {Word::kToe,
     "toe toes toebase ball metatarsal metatarsals zeh zehe zehen fussballen ballen orteil orteils "
     "dedopie dedosdelpie dedosdope artelho alluce puntapiede puntadelpie pododito палецноги пальцыног "
     "носок nosok つま先 爪先 つまさき 足先 足指 トゥ tsumasaki 脚趾 腳趾 脚尖 腳尖 趾 趾骨 jiaozhi jiaojian "
     "발가락 발끝"},

    {Word::kTail,
     "tail tailbase tailroot tailtip tailend tailbone schwanz queue cola coda rabo cauda ogon хвост hvost khvost 尾 "
     "尻尾 しっぽ 尾巴 weiba 꼬리",
     "tail"},
    {Word::kEye, "eye eyes eyeball eyeballs auge oeil yeux ojo occhio olho oko глаз glaz 目 両目 眼 眼睛 め 눈"},
    {Word::kJaw, "jaw chin kiefer machoire mandibula mascella mandibola szczeka челюсть 顎 あご 下巴 下颌 下頜 턱"},
    {Word::kHair,
     "hair hairs ponytail pigtail pigtails twintail bang bangs braid braids haar haare zopf cheveux pelo capelli "
     "cabelo "
     "wlosy волосы 髪 前髪 後髪 横髪 かみ 头发 頭髮 머리카락",
     "hair"},
    {Word::kHeadPart,
     "face tongue teeth lip lips mouth nose brow brows eyebrow eyebrows eyelid lid eyelash eyelashes cheek forehead "
     "horn antenna "
     "mandible 舌 歯 口 鼻 眉 眉毛 嘴 코 입"},
    {Word::kHeadPart,
     "ear ears ohr ohren oreille oreilles oreja orejas orecchio orecchie orelha orelhas ucho uszy ухо уши 耳 耳朵 귀",
     "ear"},

    {Word::kAttachment, "handslot slot socket prop attach attachment mount grip holder camera"},
    {Word::kAttachment, "weapon weapons waffe оружие 武器 무기", "weapon"},
    {Word::kAttachment, "sword katana sabre saber schwert espada spada меч 剣 剑", "sword"},
    {Word::kAttachment, "axe axt", "axe"},
    {Word::kAttachment, "dagger knife dolch messer", "knife"},
    {Word::kAttachment, "spear lance speer", "spear"},
    {Word::kAttachment, "hammer mace", "hammer"},
    {Word::kAttachment, "staff wand", "staff"},
    {Word::kAttachment, "shield schild bouclier escudo scudo щит 盾", "shield"},
    {Word::kAttachment, "gun pistol rifle shotgun revolver gewehr pistole", "gun"},
    {Word::kCloth, "sec breast boob bust pec pad plate 乳 乳房"},
    {Word::kCloth, "backpack rucksack knapsack mochila рюкзак リュック 背包 배낭", "backpack"},
    {Word::kCloth, "bag pouch satchel", "bag"},
    {Word::kCloth, "skirt jupe falda юбка スカート 裙 裙子 치마", "skirt"},
    {Word::kCloth, "dress kleid", "dress"},
    {Word::kCloth, "coat coattail coattails mantel", "coat"},
    {Word::kCloth, "cape", "cape"},
    {Word::kCloth, "cloak マント", "cloak"},
    {Word::kCloth, "sleeve 袖", "sleeve"},
    {Word::kCloth, "hood", "hood"},
    {Word::kCloth, "hat", "hat"},
    {Word::kCloth, "helmet helm", "helmet"},
    {Word::kCloth, "scarf", "scarf"},
    {Word::kCloth, "ribbon リボン", "ribbon"},
    {Word::kCloth, "belt", "belt"},
    {Word::kCloth, "cloth", "cloth"},
    {Word::kCloth, "armor armour", "armor"},
    {Word::kControl, "ik fk ctrl control ctl pole target mch wgt vis tweak footsteps"}};

// Short words that speak of the body only beside a side.
constexpr Line kBesideSide[]{{Word::kHand, "main te"},
                             {Word::kFoot, "pie pe"},
                             {Word::kArm, "ude bi"},
                             {Word::kShoulder, "kata jian"},
                             {Word::kLeg, "ashi"}};

// Each folded word of a text, and what it stands for.
template <typename Value>
void add(std::unordered_map<std::u32string, Value>& out, std::string_view text, Value value) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) out.emplace(fold(text.substr(0, end)), value);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

using Lexicon = std::unordered_map<std::u32string, const Line*>;

template <std::size_t N>
Lexicon lexicon_of(const Line (&lines)[N]) {
  Lexicon out;
  for (const Line& line : lines) add<const Line*>(out, line.words, &line);
  return out;
}

const Lexicon& lexicon() {
  static const auto words = lexicon_of(kLines);
  return words;
}

using Sides = std::unordered_map<std::u32string, NamedSide>;
const Sides& sides() {
  static const Sides words = [] {
    Sides out;
    add(out,
        "l left lf lft links linke linker linkes linken gauche izquierda izquierdo izq izda izdo sinistra sinistro "
        "sinistre sx esquerda esquerdo lewy lewa lewe lewo lewej левый левая левое левой лев levyi levyj levaya levaja "
        "levoe levoy 左 左側 ひだり hidari 왼쪽 왼 좌 좌측 zuo",
        NamedSide::kLeft);
    add(out,
        "r right rt rgt rechts rechte rechter rechtes rechten droit droite derecha derecho dcha dcho destra destro dx "
        "direita direito prawy prawa prawe prawo prawej правый правая правое правой прав pravyi pravyj pravaya pravaja "
        "pravoe pravoy 右 右側 みぎ migi 오른쪽 오른 우 우측",
        NamedSide::kRight);
    return out;
  }();
  return words;
}

}  // namespace

Word word_of(const std::u32string& word, bool beside_side) {
  static const auto short_words = lexicon_of(kBesideSide);
  if (const auto found = lexicon().find(word); found != lexicon().end()) return found->second->word;
  const auto found = short_words.find(word);
  return beside_side && found != short_words.end() ? found->second->word : Word::kNone;
}

std::string_view thing_of(const std::u32string& word) {
  const auto found = lexicon().find(word);
  return found == lexicon().end() ? std::string_view() : found->second->thing;
}

NamedSide side_of(const std::u32string& word) {
  const auto found = sides().find(word);
  return found == sides().end() ? NamedSide::kNone : found->second;
}

std::vector<SidedPair> pairs_with(const std::u32string& word) {
  static const std::vector<std::pair<const char*, const char*>> pairs{
      {"g", "d"},    {"i", "d"},        {"s", "d"},        {"e", "d"},          {"l", "p"},      {"л", "п"},
      {"li", "re"},  {"iz", "de"},      {"izq", "der"},    {"izq", "dch"},      {"esq", "dir"},  {"sin", "des"},
      {"sn", "dx"},  {"sin", "dx"},     {"lev", "prav"},   {"lew", "praw"},     {"gau", "dro"},  {"zuo", "you"},
      {"лев", "пр"}, {"levy", "pravy"}, {"lewa", "prawa"}, {"linke", "rechte"}, {"gche", "drte"}};
  std::vector<SidedPair> out;
  for (const auto& [left, right] : pairs) {
    const std::u32string l = fold(left), r = fold(right);
    if (word == l) out.push_back({r, NamedSide::kLeft});
    if (word == r) out.push_back({l, NamedSide::kRight});
  }
  return out;
}

const std::vector<std::u32string>& glued_sides() {
  static const std::vector<std::u32string> words = [] {
    std::vector<std::u32string> out;
    constexpr std::size_t kLong = 4;
    for (const auto& [word, side] : sides()) {
      if (word.size() >= kLong) out.push_back(word);
    }
    // "linkerarm" ends on the arm: the longer word first.
    std::sort(out.begin(), out.end(),
              [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
    return out;
  }();
  return words;
}

Place place_of(const std::u32string& word) {
  if (word == U"front" || word == U"fore" || word == U"foreleg") return Place::kFront;
  if (word == U"hind" || word == U"rear" || word == U"back" || word == U"hindleg") return Place::kHind;
  return Place::kNone;
}

Section section_of(const std::u32string& word) {
  static const std::unordered_map<std::u32string, Section> words = [] {
    std::unordered_map<std::u32string, Section> out;
    add(out,
        "upper superior superiore superieur superieure sup ober oberer oberes oberen obere haut gorny gorna gorne "
        "верхний верхняя верхнее верх verhnyaya verkhnyaya verhniy verkhniy verh 上 上部 shang 위 윗 상",
        Section::kUpper);
    add(out,
        "lower inferior inferiore inferieur inferieure inf unter unterer unteres unteren untere bas basse dolny dolna "
        "dolne нижний нижняя нижнее низ nizhnyaya nizhniy niz 下 下部 xia 아래 아랫 하",
        Section::kLower);
    return out;
  }();
  const auto found = words.find(word);
  return found == words.end() ? Section::kNone : found->second;
}

bool is_twist(const std::u32string& word) {
  static const std::unordered_map<std::u32string, bool> words = [] {
    std::unordered_map<std::u32string, bool> out;
    add(out, "twist roll foretwist twst 捩 捩り 捻 捻り 手捩 手捩り 手捻", true);
    return out;
  }();
  return words.contains(word);
}

std::size_t longest_word(const std::u32string& text, std::size_t at) {
  constexpr std::size_t kLongest = 18;
  // A syllable of Hangul ends where no vowel or final consonant follows.
  const auto ends = [&](std::size_t end) { return end == text.size() || text[end] < 0x1160 || text[end] > 0x11FF; };
  for (std::size_t length = std::min(kLongest, text.size() - at); length > 0; --length) {
    if (!ends(at + length)) continue;
    const std::u32string word = text.substr(at, length);
    if (word_of(word, true) != Word::kNone || side_of(word) != NamedSide::kNone || section_of(word) != Section::kNone ||
        is_twist(word)) {
      return length;
    }
  }
  return 0;
}

}  // namespace spherechain::baker
