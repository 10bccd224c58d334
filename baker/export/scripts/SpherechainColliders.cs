// Written by spherechain: adds the colliders of a JSON file (spherechain export --to unity) to a character.
//
// Put this file into Assets, not into a folder named Editor. Select the character in the scene, then choose
// Tools > Spherechain > Add Colliders... and the JSON file. Colliders that were added before are replaced.
//
// The file is right-handed, Unity is left-handed. Importers of FBX (Unity's own) and of glTF (glTFast, UnityGLTF,
// UniVRM 1.0) mirror X, in every bone's space: so does this script. Sizes are metres at the character's scale 1,
// whatever scale its bones have.
using System;
using System.Collections.Generic;
using System.IO;
using UnityEngine;
#if UNITY_EDITOR
using UnityEditor;
#endif

public class SpherechainColliders : MonoBehaviour
{
    [Serializable]
    public class IgnoredPair
    {
        public Transform a, b;
    }

    // Pairs of bodies between which Start disables collisions: all colliders of one against all of the other.
    public List<IgnoredPair> ignored = new List<IgnoredPair>();

    void Start()
    {
        foreach (IgnoredPair pair in ignored)
            foreach (Collider one in pair.a.GetComponentsInChildren<Collider>())
                foreach (Collider other in pair.b.GetComponentsInChildren<Collider>())
                    Physics.IgnoreCollision(one, other);
    }

    // The file. JsonUtility assigns its fields.
#pragma warning disable 0649
    [Serializable]
    class FileVolume
    {
        public string type;
        public float[] center, a, b, rotation, half;
        public float radius, radius_a, radius_b;
    }

    [Serializable]
    class FileBody
    {
        public string part, bone;
        public FileVolume[] volumes;
    }

    [Serializable]
    class FileIgnored
    {
        public string[] parts;
    }

    [Serializable]
    class ColliderFile
    {
        public string writer;
        public FileBody[] bodies;
        public FileIgnored[] ignored;
    }
#pragma warning restore 0649

    const string Prefix = "collider ";
    const int ClothMax = 32;  // of pairs of spheres, and of capsules, on one Cloth

    static Vector3 Mirrored(float[] v)
    {
        return new Vector3(-v[0], v[1], v[2]);
    }

    static Quaternion MirroredRotation(float[] q)
    {
        return new Quaternion(q[0], -q[1], -q[2], q[3]);
    }

    static T AddVolume<T>(Transform body, string name, Vector3 position, Quaternion rotation) where T : Collider
    {
        GameObject made = new GameObject(name);
        made.transform.SetParent(body, false);
        made.transform.localPosition = position;
        made.transform.localRotation = rotation;
        return made.AddComponent<T>();
    }

    static SphereCollider AddSphere(Transform body, string name, Vector3 center, float radius)
    {
        SphereCollider sphere = AddVolume<SphereCollider>(body, name, center, Quaternion.identity);
        sphere.radius = radius;
        return sphere;
    }

    static CapsuleCollider AddCapsule(Transform body, string name, Vector3 a, Vector3 b, float radius)
    {
        Quaternion turn = Quaternion.FromToRotation(Vector3.up, b - a);
        CapsuleCollider capsule = AddVolume<CapsuleCollider>(body, name, (a + b) * 0.5f, turn);
        capsule.direction = 1;  // along Y
        capsule.radius = radius;
        capsule.height = (b - a).magnitude + 2 * radius;  // from end to end
        return capsule;
    }

    // Where the bone is, turned as it is, one metre a unit where the character's own scale is 1. A kinematic Rigidbody,
    // because Unity takes moving colliders without one for walls; where the bone has a Rigidbody, a ragdoll's, they are its.
    static Transform AddBody(Transform root, Transform bone, string part)
    {
        Transform body = new GameObject(Prefix + part).transform;
        body.SetParent(bone, false);
        Vector3 scale = bone.lossyScale, whole = root.lossyScale;
        body.localScale = new Vector3(whole.x / scale.x, whole.y / scale.y, whole.z / scale.z);
        if (bone.GetComponent<Rigidbody>() == null) body.gameObject.AddComponent<Rigidbody>().isKinematic = true;
        return body;
    }

    static Transform Find(Transform below, string name)
    {
        if (below.name == name) return below;
        foreach (Transform child in below)
        {
            Transform found = Find(child, name);
            if (found != null) return found;
        }
        return null;
    }

    static void RemoveOld(Transform below)
    {
        for (int i = below.childCount - 1; i >= 0; --i)
        {
            Transform child = below.GetChild(i);
            if (child.name.StartsWith(Prefix)) DestroyImmediate(child.gameObject);
            else RemoveOld(child);
        }
    }

    // Adds the colliders to the character `root`, and gives them to each Cloth below it.
    public static SpherechainColliders Build(GameObject root, string json)
    {
        ColliderFile file = JsonUtility.FromJson<ColliderFile>(json);
        if (file.writer != "spherechain") throw new Exception("spherechain: not a file of spherechain export --to unity");
        RemoveOld(root.transform);
        Dictionary<string, Transform> bodies = new Dictionary<string, Transform>();
        List<ClothSphereColliderPair> spheres = new List<ClothSphereColliderPair>();
        List<CapsuleCollider> capsules = new List<CapsuleCollider>();
        bool hasCloth = root.GetComponentsInChildren<Cloth>().Length > 0;
        foreach (FileBody one in file.bodies)
        {
            Transform bone = Find(root.transform, one.bone);
            if (bone == null)
            {
                Debug.LogWarning("spherechain: " + root.name + " has no bone " + one.bone + "; " + one.part + " is left out");
                continue;
            }
            Transform body = AddBody(root.transform, bone, one.part);
            bodies[one.part] = body;
            foreach (FileVolume volume in one.volumes)
            {
                string name = volume.type;
                if (volume.type == "sphere")
                {
                    spheres.Add(new ClothSphereColliderPair(AddSphere(body, name, Mirrored(volume.center), volume.radius)));
                }
                else if (volume.type == "capsule")
                {
                    capsules.Add(AddCapsule(body, name, Mirrored(volume.a), Mirrored(volume.b), volume.radius));
                }
                else if (volume.type == "cone")
                {
                    // The physics has no cones: a capsule of the mean radius. A Cloth has: two spheres.
                    Vector3 a = Mirrored(volume.a), b = Mirrored(volume.b);
                    AddCapsule(body, name, a, b, (volume.radius_a + volume.radius_b) * 0.5f);
                    if (!hasCloth) continue;
                    SphereCollider first = AddSphere(body, "cloth", a, volume.radius_a);
                    SphereCollider second = AddSphere(body, "cloth", b, volume.radius_b);
                    first.isTrigger = second.isTrigger = true;
                    spheres.Add(new ClothSphereColliderPair(first, second));
                }
                else if (volume.type == "box")
                {
                    BoxCollider box = AddVolume<BoxCollider>(body, name, Mirrored(volume.center), MirroredRotation(volume.rotation));
                    box.size = new Vector3(2 * volume.half[0], 2 * volume.half[1], 2 * volume.half[2]);
                }
            }
        }
        foreach (Cloth cloth in root.GetComponentsInChildren<Cloth>())
        {
            if (spheres.Count > ClothMax || capsules.Count > ClothMax)
                Debug.LogWarning("spherechain: a Cloth takes 32 colliders of a kind; the others are left out (export with --at-most 32)");
            cloth.sphereColliders = spheres.GetRange(0, Math.Min(ClothMax, spheres.Count)).ToArray();
            cloth.capsuleColliders = capsules.GetRange(0, Math.Min(ClothMax, capsules.Count)).ToArray();
        }
        SpherechainColliders made = root.GetComponent<SpherechainColliders>();
        if (made == null) made = root.AddComponent<SpherechainColliders>();
        made.ignored.Clear();
        foreach (FileIgnored pair in file.ignored)
        {
            Transform a, b;
            if (bodies.TryGetValue(pair.parts[0], out a) && bodies.TryGetValue(pair.parts[1], out b))
                made.ignored.Add(new IgnoredPair { a = a, b = b });
        }
        return made;
    }

#if UNITY_EDITOR
    [MenuItem("Tools/Spherechain/Add Colliders...")]
    static void AddToSelection()
    {
        if (Selection.activeGameObject == null)
        {
            EditorUtility.DisplayDialog("Spherechain", "Select a character in the scene first.", "OK");
            return;
        }
        string path = EditorUtility.OpenFilePanel("Colliders of spherechain export --to unity", "Assets", "json");
        if (path == "") return;
        SpherechainColliders made = Build(Selection.activeGameObject, File.ReadAllText(path));
        EditorUtility.SetDirty(made.gameObject);
    }
#endif
}
