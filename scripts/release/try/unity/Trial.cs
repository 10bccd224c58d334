// SPDX-License-Identifier: MIT
// Trial.exe ASSET: both samples of the Unity package on a character with the asset's bones, as an importer of Unity makes it: X
// turned around. An arm is turned into the body. Contacts must show a fault, and Response must turn the arm until it is out.
using System;
using System.Collections.Generic;
using System.IO;
using System.Reflection;
using Spherechain;
using UnityEngine;

public static class Trial
{
    static void Require(bool holds, string what)
    {
        if (holds) return;
        Console.WriteLine("FAILED: " + what + " " + string.Join("; ", Debug.Lines));
        Environment.Exit(1);
    }

    static void Call(object component, string method)
    {
        component.GetType().GetMethod(method, BindingFlags.Instance | BindingFlags.NonPublic | BindingFlags.Public).Invoke(component, null);
    }

    static Matrix4x4 Mirrored(Matrix4x4 m)
    {
        Matrix4x4 turn = new Matrix4x4 { m00 = -1, m11 = 1, m22 = 1, m33 = 1 };
        return turn * m * turn;
    }

    static Matrix4x4 Local(Transform t)
    {
        Quaternion q = t.localRotation;
        return new Matrix4x4
        {
            m00 = 1 - 2 * (q.y * q.y + q.z * q.z), m01 = 2 * (q.x * q.y - q.w * q.z), m02 = 2 * (q.x * q.z + q.w * q.y),
            m10 = 2 * (q.x * q.y + q.w * q.z), m11 = 1 - 2 * (q.x * q.x + q.z * q.z), m12 = 2 * (q.y * q.z - q.w * q.x),
            m20 = 2 * (q.x * q.z - q.w * q.y), m21 = 2 * (q.y * q.z + q.w * q.x), m22 = 1 - 2 * (q.x * q.x + q.y * q.y),
            m03 = t.localPosition.x, m13 = t.localPosition.y, m23 = t.localPosition.z, m33 = 1,
        };
    }

    static Quaternion RotationOf(Matrix4x4 m)
    {
        double w = Math.Sqrt(Math.Max(0, 1 + m.m00 + m.m11 + m.m22)) / 2, x = Math.Sqrt(Math.Max(0, 1 + m.m00 - m.m11 - m.m22)) / 2;
        double y = Math.Sqrt(Math.Max(0, 1 - m.m00 + m.m11 - m.m22)) / 2, z = Math.Sqrt(Math.Max(0, 1 - m.m00 - m.m11 + m.m22)) / 2;
        return new Quaternion((float)(m.m21 < m.m12 ? -x : x), (float)(m.m02 < m.m20 ? -y : y), (float)(m.m10 < m.m01 ? -z : z), (float)w);
    }

    static Quaternion Product(Quaternion a, Quaternion b)
    {
        return new Quaternion(a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                              a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
    }

    static Matrix4x4 World(Transform t) { return t.parent == null ? Local(t) : World(t.parent) * Local(t); }

    // The asset's bones, each under the bone that its body part hangs on.
    static SkinnedMeshRenderer Skeleton(Model model, Transform root)
    {
        int count = model.BoneCount;
        SkinnedMeshRenderer renderer = new SkinnedMeshRenderer { bones = new Transform[count], sharedMesh = new Mesh { bindposes = new Matrix4x4[count] } };
        Matrix4x4[] rest = new Matrix4x4[count];
        float[] bind = new float[12];
        for (int i = 0; i < count; ++i)
        {
            model.InverseBind(i, bind);
            Matrix4x4 inverse = Mirrored(new Matrix4x4(new[] { bind[0], bind[4], bind[8], 0, bind[1], bind[5], bind[9], 0,
                                                               bind[2], bind[6], bind[10], 0, bind[3], bind[7], bind[11], 1 }, 0));
            renderer.sharedMesh.bindposes[i] = inverse;
            rest[i] = inverse.inverse;
            renderer.bones[i] = new Transform { name = model.BoneNames[i], parent = root };
        }
        for (int part = 0; part < model.PartCount; ++part)
        {
            int bone = model.PartBone(part), parent = model.PartParent(part) < 0 ? -1 : model.PartBone(model.PartParent(part));
            if (bone >= 0 && parent >= 0 && bone != parent) renderer.bones[bone].parent = renderer.bones[parent];
        }
        for (int i = 0; i < count; ++i)
        {
            int above = Array.IndexOf(renderer.bones, renderer.bones[i].parent);
            Matrix4x4 local = above < 0 ? rest[i] : renderer.sharedMesh.bindposes[above] * rest[i];
            renderer.bones[i].localRotation = RotationOf(local);
            renderer.bones[i].localPosition = new Vector3(local.m03, local.m13, local.m23);
        }
        return renderer;
    }

    static void Update(SkinnedMeshRenderer renderer)
    {
        foreach (Transform bone in renderer.bones) bone.localToWorldMatrix = World(bone);
    }

    static float Deepest(SelfCollision contacts, SkinnedMeshRenderer renderer)
    {
        Update(renderer);
        Call(contacts, "LateUpdate");
        float depth = 0;
        foreach (Penetration found in contacts.Penetrations)
        {
            if (found.Kind >= PenetrationClass.Penetration) depth = Math.Max(depth, found.Measures.Depth);
        }
        return depth;
    }

    public static int Main(string[] arguments)
    {
        byte[] file = File.ReadAllBytes(arguments[0]);
        Model model = new Model(file);
        SelfCollision contacts = new SelfCollision { asset = new TextAsset { bytes = file } };
        contacts.transform.localToWorldMatrix = new Matrix4x4 { m00 = 1, m11 = 1, m22 = 1, m33 = 1 };
        SkinnedMeshRenderer renderer = Skeleton(model, contacts.transform);
        contacts.below = new[] { renderer };
        SelfCollisionResponse response = new SelfCollisionResponse { asset = contacts.asset, below = contacts.below, transform = contacts.transform };
        Call(contacts, "OnEnable");
        Call(response, "OnEnable");
        Require(contacts.enabled && response.enabled, "the samples bind");
        Require(Deepest(contacts, renderer) == 0, "no fault at rest");

        Transform arm = renderer.bones[model.PartBone(Array.IndexOf(model.PartNames, "left upper arm"))];
        Quaternion rest = arm.localRotation;
        float deepest = 0;
        for (float angle = 0; angle <= 2 && deepest < 0.01f * model.Height; angle += 0.05f)
        {
            for (int side = -1; side <= 1 && deepest < 0.01f * model.Height; side += 2)  // which way is down depends on the axes
            {
                float sin = side * (float)Math.Sin(angle / 2);  // about no axis of the file, so a wrong mirror shows
                arm.localRotation = Product(rest, new Quaternion(0.36f * sin, 0.48f * sin, 0.8f * sin, (float)Math.Cos(angle / 2)));
                deepest = Deepest(contacts, renderer);
            }
        }
        Require(deepest > 0, "an arm goes into the body");
        Penetration first = contacts.Penetrations[0];
        Console.WriteLine("{0} in {1}: {2:F1} % of the height", contacts.PartName(first.Part), contacts.PartName(first.Other), 100 * first.Measures.Depth / model.Height);

        Quaternion animated = arm.localRotation;
        for (int frame = 0; frame < 40; ++frame)  // the arm is animated
        {
            arm.localRotation = animated;
            Call(response, "LateUpdate");
        }
        float expected = arm.localRotation.z, left = Deepest(contacts, renderer);
        Require(response.Turned > 0 && left < 0.5f * deepest, "the response brings the arm out: " + left + " of " + deepest);
        arm.localRotation = animated;
        response.Forget();
        for (int frame = 0; frame < 40; ++frame) Call(response, "LateUpdate");  // nobody animates it any more
        Require(Math.Abs(arm.localRotation.z - expected) < 1e-4f, "corrections of a pose that stays do not add up");
        response.weakness = 1;
        for (int frame = 0; frame < 40; ++frame) Call(response, "LateUpdate");
        Require(arm.localRotation.z == animated.z, "with weakness 1 the arm is as animated");
        Console.WriteLine("after the response: {0:F1} %", 100 * left / model.Height);
        Require(Debug.Lines.Count == 0, "nothing is logged");
        return 0;
    }
}
