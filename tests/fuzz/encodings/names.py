# SPDX-License-Identifier: GPL-3.0-or-later
"""What people call the man's joints."""
from man import JOINTS

ROLES = [name for name, _, _ in JOINTS]
MIDDLE = ["Hips", "Spine", "Chest", "Neck", "Head"]
SIDED = ["Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot"]


def table(middle, sided, left, right, form="{side}{name}"):
    """The five names of the middle, the seven of a side, and how a side is said."""
    out = dict(zip(MIDDLE, middle.split()))
    for role, name in zip(SIDED, sided.split()):
        out["Left" + role] = form.format(side=left, name=name)
        out["Right" + role] = form.format(side=right, name=name)
    return {role: name.replace("~", " ") for role, name in out.items()}


SCHEMES = {
    "plain": {role: role for role in ROLES},
    "mixamo": table("mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Neck mixamorig:Head",
                    "Shoulder Arm ForeArm Hand UpLeg Leg Foot", "mixamorig:Left", "mixamorig:Right"),
    "namespace": {role: "hero:rig:" + role for role in ROLES},
    "prefix": {role: "CC_Base_" + role for role in ROLES},
    "blender": table("hips spine chest neck head", "shoulder upper_arm forearm hand thigh shin foot", ".L", ".R",
                     "{name}{side}"),
    "biped": table("Bip01 Bip01~Spine Bip01~Spine1 Bip01~Neck Bip01~Head",
                   "Clavicle UpperArm Forearm Hand Thigh Calf Foot", "Bip01 L ", "Bip01 R "),
    "unreal": table("pelvis spine_01 spine_02 neck_01 head", "clavicle upperarm lowerarm hand thigh calf foot", "_l",
                    "_r", "{name}{side}"),
    "german": table("Hüfte Wirbelsäule Brust Hals Kopf",
                    "Schulter Oberarm Unterarm Hand Oberschenkel Unterschenkel Fuß", "links", "rechts",
                    "{name}_{side}"),
    "french": table("hanches colonne poitrine cou tête", "épaule bras avant-bras main cuisse jambe pied", "gauche",
                    "droite", "{name}_{side}"),
    "spanish": table("cadera columna pecho cuello cabeza", "hombro brazo antebrazo mano muslo pierna pie",
                     "izquierda", "derecha", "{name}_{side}"),
    "italian": table("bacino spina petto collo testa", "spalla braccio avambraccio mano coscia gamba piede",
                     "sinistra", "destra", "{name}_{side}"),
    "portuguese": table("quadril coluna peito pescoço cabeça", "ombro braço antebraço mão coxa perna pé", "esquerda",
                        "direita", "{name}_{side}"),
    "russian": table("таз позвоночник грудь шея голова", "ключица плечо предплечье кисть бедро голень стопа",
                     "левая", "правая", "{name}_{side}"),
    "polish": table("miednica kręgosłup klatka szyja głowa", "bark ramię przedramię dłoń udo łydka stopa", "lewa",
                    "prawa", "{name}_{side}"),
    "japanese": table("腰 上半身 上半身2 首 頭", "肩 腕 ひじ 手首 足 ひざ 足首", "左", "右"),
    "chinese": table("臀部 脊柱 胸部 颈部 头部", "肩膀 上臂 前臂 手 大腿 小腿 脚", "左", "右"),
    "korean": table("골반 척추 가슴 목 머리", "어깨 위팔 아래팔 손 허벅지 종아리 발", "왼쪽", "오른쪽"),
    "numbers": {role: f"joint{k}" for k, role in enumerate(ROLES)},
    "codes": {role: f"b_{k * 7919 % 1000:03}" for k, role in enumerate(ROLES)},
    "one name": {role: "bone" for role in ROLES},
}
UNIQUE = {name for name, scheme in SCHEMES.items() if len(set(scheme.values())) == len(ROLES)}


def rename(scene, scheme, rng):
    words = SCHEMES[scheme]
    for node in scene.nodes:
        if node.role:
            node.name = words[node.role]
        elif any(node.name.startswith(role) for role in ROLES) and scheme != "plain":
            role = max((r for r in ROLES if node.name.startswith(r)), key=len)
            node.name = words[role] + node.name[len(role):]
