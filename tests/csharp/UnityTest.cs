// SPDX-License-Identifier: MIT
// UnityTest.exe ASSET.sphc PALETTES: SelfCollision.cs on a character as an importer of Unity makes it, X turned around and
// metres made of another unit, the character moved, turned and scaled: the same faults as a Body's in the source's space.
using System;
using System.IO;
using System.Reflection;
using Spherechain;
using UnityEngine;

public static class UnityTest
{
    const float kUnit = 0.01f;  // of Unity's, a source unit

    static int failures;

    static void Check(bool holds, string what)
    {
        if (holds) return;
        ++failures;
        Console.WriteLine("FAILED: " + what);
    }

    static void Call(SelfCollision component, string method)
    {
        typeof(SelfCollision).GetMethod(method, BindingFlags.Instance | BindingFlags.NonPublic | BindingFlags.Public).Invoke(component, null);
    }

    // Turns a matrix as an importer does: X turned on both sides, lengths in its own unit. Written apart from Mirror.
    static Matrix4x4 Imported(Matrix4x4 m)
    {
        Matrix4x4 turn = new Matrix4x4 { m00 = -kUnit, m11 = kUnit, m22 = kUnit, m33 = 1 };
        return turn * m * turn.inverse;
    }

    static SelfCollision Make(byte[] file, Palettes model, Matrix4x4 root)
    {
        SkinnedMeshRenderer renderer = new SkinnedMeshRenderer { bones = new Transform[model.Joints.Length], sharedMesh = new Mesh() };
        renderer.sharedMesh.bindposes = new Matrix4x4[model.Joints.Length];
        for (int i = 0; i < model.Joints.Length; ++i)
        {
            renderer.bones[i] = new Transform { name = model.Joints[i] };
            renderer.sharedMesh.bindposes[i] = Imported(new Matrix4x4(model.InverseBinds, 16 * i));
        }
        SelfCollision component = new SelfCollision { asset = new TextAsset { bytes = file }, sourceUnit = kUnit, keepsDirections = false };
        component.below = new[] { renderer };
        component.transform.localToWorldMatrix = root;
        return component;
    }

    static void Stand(SelfCollision component, Palettes model, float[] palette, Matrix4x4 root)
    {
        for (int i = 0; i < model.Joints.Length; ++i)
        {
            Matrix4x4 world = new Matrix4x4(palette, 16 * i) * new Matrix4x4(model.InverseBinds, 16 * i).inverse;
            component.renderers[0].bones[i].localToWorldMatrix = root * Imported(world);
        }
    }

    static float Distance(Vector3 a, Vector3 b)
    {
        return (float)Math.Sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
    }

    // The fault of the same parts, or an empty one.
    static Penetration Find(SelfCollision component, Penetration like)
    {
        foreach (Penetration found in component.Penetrations)
        {
            if (found.Part == like.Part && found.Other == like.Other) return found;
        }
        return default(Penetration);
    }

    public static int Main(string[] arguments)
    {
        byte[] file = File.ReadAllBytes(arguments[0]);
        Palettes model = new Palettes(arguments[1]);
        // Turned about y, twice as large, far away.
        Matrix4x4 root = new Matrix4x4 { m00 = 1.2f, m02 = 1.6f, m11 = 2, m20 = -1.6f, m22 = 1.2f, m03 = 30, m13 = -5, m23 = 12, m33 = 1 };

        SelfCollision wrong = Make(file, model, root);
        wrong.mirroredAxis = Axis.None;
        Call(wrong, "OnEnable");
        Check(!wrong.enabled && Debug.Lines.Count == 1 && Debug.Lines[0].Contains("inverse bind"), "a wrong axis is refused: " + string.Join("; ", Debug.Lines));
        Debug.Lines.Clear();

        SelfCollision component = Make(file, model, root);
        Call(component, "OnEnable");
        Check(component.enabled, string.Join("; ", Debug.Lines));
        if (failures > 0) return 1;
        Stand(component, model, model.Rest, root);
        component.CheckBindPose();
        Check(Debug.Lines.Count == 1 && Debug.Lines[0] == "log: SelfCollision: the matrices fit", string.Join("; ", Debug.Lines));

        int faults = 0, drawn = 0;
        using (Model source = new Model(file, model.Joints, model.InverseBinds, MatrixLayout.Columns4x4))
        using (Body reference = new Body(source))
        {
            float height = source.Height;
            for (int frame = 0; frame < model.Frames.Length; frame += 3)
            {
                Stand(component, model, model.Frames[frame], root);
                Call(component, "LateUpdate");
                // Matrices went through a scene of 30 units in floats; the way out of a fault may change with that.
                FieldInfo field = typeof(SelfCollision).GetField("palette", BindingFlags.Instance | BindingFlags.NonPublic);
                float[] palette = (float[])field.GetValue(component);
                for (int i = 0; i < palette.Length; ++i)
                {
                    Check(Math.Abs(palette[i] - model.Frames[frame][i]) < 0.001f * Math.Max(1, height), "frame " + frame + ": the palette differs");
                }
                reference.SetPose(palette, MatrixLayout.Columns4x4);
                foreach (Penetration expected in reference.Penetrations())
                {
                    if (expected.Kind < PenetrationClass.Penetration || expected.Measures.Depth < 0.01f * height) continue;
                    ++faults;
                    Penetration found = Find(component, expected);
                    Vec3 d = expected.Direction;
                    float length = kUnit * expected.Distance;
                    Vector3 way = new Vector3(-length * d.X, length * d.Y, length * d.Z);
                    Check(Distance(component.Direction(found), way) < 1e-5f * kUnit * height, "frame " + frame + ": the way out differs");
                    Vec3 at = expected.Deepest.Position;
                    Check(Distance(component.Position(found.Deepest.Position), new Vector3(-kUnit * at.X, kUnit * at.Y, kUnit * at.Z)) <
                          1e-5f * kUnit * height, "frame " + frame + ": the deepest point differs");
                }
                Call(component, "OnDrawGizmosSelected");
                drawn += component.Penetrations.Count;
            }
        }
        Check(faults > 20, "only " + faults + " faults were compared");
        Check(Gizmos.Spheres == drawn && Gizmos.Lines == drawn && Gizmos.RedSpheres > faults, "gizmos");
        Call(component, "OnDisable");
        Console.WriteLine("{0} faults compared, {1} failures", faults, failures);
        return failures == 0 ? 0 : 1;
    }
}
