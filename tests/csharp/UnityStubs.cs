// SPDX-License-Identifier: MIT
// The types of UnityEngine that the components use, written from its documentation: matrices are column-major, m01 is row 0 of column
// 1. Bones are given by their world matrices, and apart from them by parent, place and rotation; there is no scene.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class TooltipAttribute : Attribute { public TooltipAttribute(string text) { } }
    [AttributeUsage(AttributeTargets.Field)]
    public sealed class RangeAttribute : Attribute { public RangeAttribute(float low, float high) { } }
    [AttributeUsage(AttributeTargets.Class)]
    public sealed class DefaultExecutionOrder : Attribute { public DefaultExecutionOrder(int order) { } }
    [AttributeUsage(AttributeTargets.Method)]
    public sealed class ContextMenuAttribute : Attribute { public ContextMenuAttribute(string name) { } }

    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 operator +(Vector3 a, Vector3 b) { return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z); }
    }

    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
    }

    public struct Color
    {
        public float r;
        public static Color red { get { return new Color { r = 1 }; } }
        public static Color green { get { return new Color(); } }
    }

    public struct Matrix4x4
    {
        public float m00, m10, m20, m30, m01, m11, m21, m31, m02, m12, m22, m32, m03, m13, m23, m33;

        public Matrix4x4(float[] columns, int at)
        {
            m00 = columns[at]; m10 = columns[at + 1]; m20 = columns[at + 2]; m30 = columns[at + 3];
            m01 = columns[at + 4]; m11 = columns[at + 5]; m21 = columns[at + 6]; m31 = columns[at + 7];
            m02 = columns[at + 8]; m12 = columns[at + 9]; m22 = columns[at + 10]; m32 = columns[at + 11];
            m03 = columns[at + 12]; m13 = columns[at + 13]; m23 = columns[at + 14]; m33 = columns[at + 15];
        }

        public float[] Columns()
        {
            return new[] { m00, m10, m20, m30, m01, m11, m21, m31, m02, m12, m22, m32, m03, m13, m23, m33 };
        }

        public static Matrix4x4 operator *(Matrix4x4 a, Matrix4x4 b)
        {
            return new Matrix4x4
            {
                m00 = a.m00 * b.m00 + a.m01 * b.m10 + a.m02 * b.m20 + a.m03 * b.m30,
                m01 = a.m00 * b.m01 + a.m01 * b.m11 + a.m02 * b.m21 + a.m03 * b.m31,
                m02 = a.m00 * b.m02 + a.m01 * b.m12 + a.m02 * b.m22 + a.m03 * b.m32,
                m03 = a.m00 * b.m03 + a.m01 * b.m13 + a.m02 * b.m23 + a.m03 * b.m33,
                m10 = a.m10 * b.m00 + a.m11 * b.m10 + a.m12 * b.m20 + a.m13 * b.m30,
                m11 = a.m10 * b.m01 + a.m11 * b.m11 + a.m12 * b.m21 + a.m13 * b.m31,
                m12 = a.m10 * b.m02 + a.m11 * b.m12 + a.m12 * b.m22 + a.m13 * b.m32,
                m13 = a.m10 * b.m03 + a.m11 * b.m13 + a.m12 * b.m23 + a.m13 * b.m33,
                m20 = a.m20 * b.m00 + a.m21 * b.m10 + a.m22 * b.m20 + a.m23 * b.m30,
                m21 = a.m20 * b.m01 + a.m21 * b.m11 + a.m22 * b.m21 + a.m23 * b.m31,
                m22 = a.m20 * b.m02 + a.m21 * b.m12 + a.m22 * b.m22 + a.m23 * b.m32,
                m23 = a.m20 * b.m03 + a.m21 * b.m13 + a.m22 * b.m23 + a.m23 * b.m33,
                m33 = 1,
            };
        }

        public Matrix4x4 inverse
        {
            get
            {
                double a = m00, b = m01, c = m02, d = m10, e = m11, f = m12, g = m20, h = m21, i = m22;
                double A = e * i - f * h, B = c * h - b * i, C = b * f - c * e;
                double det = a * A + d * B + g * C;
                double D = f * g - d * i, E = a * i - c * g, F = c * d - a * f;
                double G = d * h - e * g, H = b * g - a * h, I = a * e - b * d;
                return new Matrix4x4
                {
                    m00 = (float)(A / det), m01 = (float)(B / det), m02 = (float)(C / det),
                    m10 = (float)(D / det), m11 = (float)(E / det), m12 = (float)(F / det),
                    m20 = (float)(G / det), m21 = (float)(H / det), m22 = (float)(I / det),
                    m03 = (float)(-(A * m03 + B * m13 + C * m23) / det),
                    m13 = (float)(-(D * m03 + E * m13 + F * m23) / det),
                    m23 = (float)(-(G * m03 + H * m13 + I * m23) / det),
                    m33 = 1,
                };
            }
        }
    }

    public class Object { public string name = ""; }

    public sealed class TextAsset : Object { public byte[] bytes; }

    public sealed class Transform : Object
    {
        public Matrix4x4 localToWorldMatrix;
        public Transform parent;
        public Vector3 localPosition, localScale = new Vector3(1, 1, 1);
        public Quaternion localRotation = new Quaternion(0, 0, 0, 1);
        public Matrix4x4 worldToLocalMatrix { get { return localToWorldMatrix.inverse; } }
    }

    public sealed class Mesh : Object { public Matrix4x4[] bindposes; }

    public sealed class SkinnedMeshRenderer : Object
    {
        public Transform[] bones;
        public Mesh sharedMesh;
    }

    public class MonoBehaviour : Object
    {
        public bool enabled = true;
        public Transform transform = new Transform();
        public SkinnedMeshRenderer[] below;
        public T[] GetComponentsInChildren<T>() { return (T[])(object)below; }
    }

    public static class Debug
    {
        public static readonly List<string> Lines = new List<string>();
        public static void Log(object text, Object context) { Lines.Add("log: " + text); }
        public static void LogError(object text, Object context) { Lines.Add("error: " + text); }
    }

    public static class Time { public static float deltaTime = 1 / 30f; }

    public static class Gizmos
    {
        public static Matrix4x4 matrix;
        public static Color color;
        public static int Spheres, RedSpheres, Lines;
        public static void DrawSphere(Vector3 at, float radius) { ++Spheres; if (color.r == 1) ++RedSpheres; }
        public static void DrawLine(Vector3 from, Vector3 to) { ++Lines; }
    }
}
