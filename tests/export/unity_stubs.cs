// SPDX-License-Identifier: GPL-3.0-or-later
// As much of Unity as SpherechainColliders.cs needs, and a program that runs it: FILE SKELETON, where a line of
// SKELETON is a bone's name, position, rotation and scale. Prints the colliders in the character's space.
using System;
using System.Collections;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Reflection;
using System.Text;
using UnityEngine;

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 up { get { return new Vector3(0, 1, 0); } }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public float magnitude { get { return (float)Math.Sqrt(Dot(this, this)); } }
        public Vector3 normalized { get { return this * (1 / magnitude); } }
        public static Vector3 operator +(Vector3 a, Vector3 b) { return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z); }
        public static Vector3 operator -(Vector3 a, Vector3 b) { return a + b * -1; }
        public static Vector3 operator *(Vector3 a, float s) { return new Vector3(a.x * s, a.y * s, a.z * s); }
        public static float Dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
        public static Vector3 Cross(Vector3 a, Vector3 b)
        {
            return new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
        }
        public static Vector3 Scale(Vector3 a, Vector3 b) { return new Vector3(a.x * b.x, a.y * b.y, a.z * b.z); }
    }

    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
        public static Quaternion identity { get { return new Quaternion(0, 0, 0, 1); } }
        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            Vector3 u = new Vector3(q.x, q.y, q.z), t = Vector3.Cross(u, v) * 2;
            return v + t * q.w + Vector3.Cross(u, t);
        }
        public static Quaternion operator *(Quaternion a, Quaternion b)
        {
            return new Quaternion(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
        }
        public static Quaternion FromToRotation(Vector3 from, Vector3 to)
        {
            if (to.magnitude == 0) return identity;
            Vector3 a = from.normalized, b = to.normalized, axis = Vector3.Cross(a, b);
            double angle = Math.Atan2(axis.magnitude, Vector3.Dot(a, b));
            if (axis.magnitude == 0) axis = new Vector3(1, 0, 0);
            axis = axis.normalized * (float)Math.Sin(angle / 2);
            return new Quaternion(axis.x, axis.y, axis.z, (float)Math.Cos(angle / 2));
        }
    }

    public class Object
    {
        public string name { get; set; }
        public static void DestroyImmediate(GameObject gone) { gone.transform.SetParent(null, false); }
    }

    public class Component : Object
    {
        public GameObject gameObject;
        public new string name { get { return gameObject.name; } }
        public Transform transform { get { return gameObject.transform; } }
        public T GetComponent<T>() where T : Component { return gameObject.GetComponent<T>(); }
        public T[] GetComponentsInChildren<T>() where T : Component { return gameObject.GetComponentsInChildren<T>(); }
    }

    public class MonoBehaviour : Component { }

    public class Transform : Component, IEnumerable
    {
        readonly List<Transform> children = new List<Transform>();
        Transform parent;
        public Vector3 localPosition, localScale = Vector3.one;
        public Quaternion localRotation = Quaternion.identity;
        public int childCount { get { return children.Count; } }
        public Transform Parent { get { return parent; } }
        public Transform GetChild(int i) { return children[i]; }
        public IEnumerator GetEnumerator() { return children.GetEnumerator(); }
        public void SetParent(Transform to, bool worldPositionStays)
        {
            if (parent != null) parent.children.Remove(this);
            parent = to;
            if (to != null) to.children.Add(this);
        }
        public Vector3 lossyScale
        {
            get { return parent == null ? localScale : Vector3.Scale(parent.lossyScale, localScale); }
        }
        public Quaternion rotation { get { return parent == null ? localRotation : parent.rotation * localRotation; } }
        public Vector3 TransformPoint(Vector3 p)
        {
            Vector3 above = localPosition + localRotation * Vector3.Scale(localScale, p);
            return parent == null ? above : parent.TransformPoint(above);
        }
    }

    public class GameObject : Object
    {
        readonly List<Component> components = new List<Component>();
        public Transform transform { get; private set; }
        public GameObject(string name) { this.name = name; transform = AddComponent<Transform>(); }
        public T AddComponent<T>() where T : Component
        {
            T made = Activator.CreateInstance<T>();
            made.gameObject = this;
            components.Add(made);
            return made;
        }
        public T GetComponent<T>() where T : Component { return components.OfType<T>().FirstOrDefault(); }
        public T[] GetComponentsInChildren<T>() where T : Component
        {
            return components.OfType<T>().Concat(transform.Cast<Transform>().SelectMany(t => t.GetComponentsInChildren<T>())).ToArray();
        }
    }

    public class Rigidbody : Component { public bool isKinematic; }
    public class Collider : Component { public bool isTrigger; }
    public class SphereCollider : Collider { public Vector3 center; public float radius; }
    public class CapsuleCollider : Collider { public Vector3 center; public float radius, height; public int direction; }
    public class BoxCollider : Collider { public Vector3 center, size; }

    public struct ClothSphereColliderPair
    {
        public SphereCollider first, second;
        public ClothSphereColliderPair(SphereCollider a) { first = a; second = null; }
        public ClothSphereColliderPair(SphereCollider a, SphereCollider b) { first = a; second = b; }
    }

    public class Cloth : Component
    {
        public ClothSphereColliderPair[] sphereColliders;
        public CapsuleCollider[] capsuleColliders;
    }

    public static class Physics
    {
        public static readonly HashSet<string> Ignored = new HashSet<string>();
        public static void IgnoreCollision(Collider a, Collider b)
        {
            Ignored.Add("[" + Program.Quoted(a.transform.Parent.name) + ", " + Program.Quoted(b.transform.Parent.name) + "]");
        }
    }

    public static class Debug { public static void LogWarning(string text) { Console.Error.WriteLine(text); } }

    // Serializes as Unity does: public fields of [Serializable] classes, strings, numbers, arrays of those, no nested
    // arrays.
    public static class JsonUtility
    {
        public static T FromJson<T>(string json) { int at = 0; return (T)Read(json, ref at, typeof(T)); }

        static char Next(string s, ref int at) { while (char.IsWhiteSpace(s[at])) ++at; return s[at]; }

        static object Read(string s, ref int at, Type type)
        {
            char c = Next(s, ref at);
            if (c == '{') return ReadObject(s, ref at, type);
            if (c == '[') return ReadArray(s, ref at, type);
            if (c == '"')
            {
                StringBuilder text = new StringBuilder();
                for (++at; s[at] != '"'; ++at) text.Append(s[at] == '\\' ? s[++at] : s[at]);
                ++at;
                return text.ToString();
            }
            int start = at;
            while (",]} \n".IndexOf(s[at]) < 0) ++at;
            string word = s.Substring(start, at - start);
            if (word == "null") return type == typeof(string) ? "" : null;
            return (float)double.Parse(word, CultureInfo.InvariantCulture);
        }

        static object ReadObject(string s, ref int at, Type type)
        {
            if (type != null && !type.IsSerializable) throw new Exception(type + " is not serializable");
            object made = type == null ? null : Activator.CreateInstance(type, true);
            for (++at; Next(s, ref at) != '}';)
            {
                string key = (string)Read(s, ref at, typeof(string));
                if (Next(s, ref at) == ':') ++at;
                FieldInfo field = type == null ? null : type.GetField(key);
                object value = Read(s, ref at, field == null ? null : field.FieldType);
                if (field != null) field.SetValue(made, value);
                if (Next(s, ref at) == ',') ++at;
            }
            ++at;
            return made;
        }

        static object ReadArray(string s, ref int at, Type type)
        {
            Type element = type == null ? null : type.GetElementType();
            if (element != null && element.IsArray) throw new Exception("an array of arrays");
            ArrayList list = new ArrayList();
            for (++at; Next(s, ref at) != ']';)
            {
                list.Add(Read(s, ref at, element));
                if (Next(s, ref at) == ',') ++at;
            }
            ++at;
            return element == null ? null : list.ToArray(element);
        }
    }
}

namespace UnityEditor
{
    public class MenuItem : Attribute { public MenuItem(string path) { } }
    public static class Selection { public static GameObject activeGameObject = null; }
    public static class EditorUtility
    {
        public static void DisplayDialog(string title, string text, string ok) { }
        public static string OpenFilePanel(string title, string folder, string ending) { return ""; }
        public static void SetDirty(UnityEngine.Object changed) { }
    }
}

static class Program
{
    const float Whole = 2;  // the scale at which somebody set the character into a scene

    public static string Quoted(string text) { return "\"" + text.Replace("\\", "\\\\").Replace("\"", "\\\"") + "\""; }

    static string Text(params float[] numbers)
    {
        return "[" + string.Join(", ", numbers.Select(n => n.ToString("R", CultureInfo.InvariantCulture))) + "]";
    }

    static string Describe(Collider one)
    {
        Transform at = one.transform;
        SphereCollider sphere = one as SphereCollider;
        CapsuleCollider capsule = one as CapsuleCollider;
        BoxCollider box = one as BoxCollider;
        Vector3 center = sphere != null ? sphere.center : capsule != null ? capsule.center : box.center;
        Vector3 p = at.TransformPoint(center) * (1 / Whole);
        Quaternion q = at.rotation;
        float scale = at.lossyScale.x / Whole;
        string size = sphere != null ? "\"radius\": " + Text(sphere.radius * scale).Trim('[', ']')
            : capsule != null ? "\"direction\": " + capsule.direction + ", \"radius\": " + Text(capsule.radius * scale).Trim('[', ']') + ", \"height\": " + Text(capsule.height * scale).Trim('[', ']')
            : "\"size\": " + Text(box.size.x * scale, box.size.y * scale, box.size.z * scale);
        return "{\"body\": " + Quoted(at.Parent.name) + ", \"name\": " + Quoted(one.name) + ", \"type\": " + Quoted(one.GetType().Name) +
            ", \"position\": " + Text(p.x, p.y, p.z) + ", \"rotation\": " + Text(q.x, q.y, q.z, q.w) + ", " + size + "}";
    }

    static void Main(string[] args)
    {
        GameObject root = new GameObject("character");
        root.transform.localScale = Vector3.one * Whole;
        Cloth cloth = root.AddComponent<Cloth>();
        foreach (string line in File.ReadAllLines(args[1]))
        {
            string[] words = line.Split('\t');
            float[] n = words.Skip(1).Select(w => (float)double.Parse(w, CultureInfo.InvariantCulture)).ToArray();
            Transform bone = new GameObject(words[0]).transform;
            bone.SetParent(root.transform, false);
            bone.localPosition = new Vector3(n[0], n[1], n[2]);
            bone.localRotation = new Quaternion(n[3], n[4], n[5], n[6]);
            bone.localScale = Vector3.one * n[7];
        }
        string json = File.ReadAllText(args[0]);
        SpherechainColliders.Build(root, json);
        SpherechainColliders made = SpherechainColliders.Build(root, json);  // the second time in place of the first
        typeof(SpherechainColliders).GetMethod("Start", BindingFlags.NonPublic | BindingFlags.Instance).Invoke(made, null);
        Console.WriteLine("{\"colliders\": [" + string.Join(",\n", root.GetComponentsInChildren<Collider>().Select(Describe)) +
            "], \"ignored\": [" + string.Join(", ", Physics.Ignored) + "], \"cloth\": {\"spheres\": " +
            cloth.sphereColliders.Length + ", \"capsules\": " + cloth.capsuleColliders.Length + "}}");
    }
}
